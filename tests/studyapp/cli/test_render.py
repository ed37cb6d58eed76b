"""`motionjury render`, `motionjury preview` and `motionjury publish-media`."""

import os
import re
from pathlib import Path
from unittest.mock import Mock

import av
import pytest
import trimesh

from motion.audio import read_audio
from motion.formats import read_motion
from motion.formats.bvh_motion import write_clip_bvh
from motion.skeleton import JOINT_NAMES, REST_JOINTS
from studyapp.stimuli import rendering
from studyapp.stimuli.render_record import RenderCount
from tests.motion.random_clips import random_clip
from tests.support.command_line import refused, run, run_in_terminal
from tests.support.encoded import pictures_of
from tests.support.servers.s3_stand_in import BUCKET, SECRET, Store
from tests.support.studies.takes import write_motion, write_speech


@pytest.mark.parametrize(("available", "used"), [(3, 3), (384, 256)])
def test_all_processors_are_used_by_default_and_failures_are_printed(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch, available: int, used: int
) -> None:
    count = RenderCount(made=3, kept=2, failures=("a.mp4: torn",), left_out=2, notes=("soft",))
    render = Mock(return_value=count)
    monkeypatch.setattr(rendering, "render", render)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(available)), raising=False)
    output = run("render", tiny_study, status=1)

    assert render.call_args.kwargs["processes"] == used
    assert "soft" in output
    assert "failed: a.mp4: torn" in output
    assert "skipped 2 videos made from these clips" in output
    assert "Rendered 3 videos, kept 2 up-to-date ones." in output
    assert "3 videos could not be made" in output


def test_a_motion_of_an_unknown_skeleton_is_shown_with_a_joint_map(tmp_path: Path) -> None:
    unknown_skeleton = tmp_path / "wave.bvh"
    write_clip_bvh(unknown_skeleton, random_clip(20), REST_JOINTS)
    text = unknown_skeleton.read_text()
    unknown_skeleton.write_text(re.sub("(ROOT|JOINT) ", r"\1 x", text))
    out = ("--as", "video", "--size", 64, "--out", tmp_path / "out")
    arguments = ("preview", unknown_skeleton, *out)
    error = refused(*arguments)
    assert "skeleton is unknown" in error
    assert "--joints FILE" in error
    joints = tmp_path / "joints.toml"
    joints.write_text("".join(f'{name} = "x{name}"\n' for name in JOINT_NAMES))
    run(*arguments, "--joints", joints)
    with av.open(str(tmp_path / "out" / "wave.mp4")) as video:
        assert {stream.type for stream in video.streams} == {"video", "audio"}


def test_a_motion_is_cut_to_its_speech_with_a_note_and_each_frame_is_a_sign_of_life(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = write_motion(tmp_path / "a.npz", 1.0)
    speech = write_speech(tmp_path / "a.wav", 0.5)
    given = ("--speech", speech, "--as", "video", "--size", 64)
    output = run_in_terminal(monkeypatch, "preview", motion, *given, "--out", tmp_path)
    assert "cut to the common 0.50 s" in output
    assert "preview: reading a.npz" in output and "a.mp4, frame 15 of 15" in output
    assert len(pictures_of(tmp_path / "a.mp4")) == 15


def test_motions_are_converted_with_their_speech_and_none_is_overwritten(tmp_path: Path) -> None:
    motions = [write_motion(tmp_path / name / "a.npz", 1.0) for name in ("ours", "theirs")]
    speech = write_speech(tmp_path / "a.wav", 0.5)
    out = tmp_path / "out"
    run("preview", *motions, "--speech", speech, "--as", "glb", "--as", "bvh", "--out", out)
    endings = (".glb", ".bvh", "-speech.wav")
    names = {f"{name}-a{ending}" for name in ("ours", "theirs") for ending in endings}
    assert {path.name for path in out.iterdir()} == names
    assert read_audio(out / "ours-a-speech.wav").duration == pytest.approx(0.5)
    scene = trimesh.load_scene(out / "ours-a.glb")
    assert scene.graph.get("pelvis")[0][1, 3] > 0.5
    assert read_motion(out / "ours-a.bvh").duration == pytest.approx(0.5)
    before = (out / "ours-a.bvh").read_bytes()
    again = refused("preview", "--as", "bvh", "--out", out, out / "ours-a.bvh")
    assert "Choose another folder (--out)" in again
    assert (out / "ours-a.bvh").read_bytes() == before


def test_videos_are_uploaded_and_loaded_as_by_a_browser(tiny_study: Path, s3_store: Store) -> None:
    assert "no bucket was given" in run("publish-media", tiny_study, status=1)
    s3_store.origins = ["https://study.example.org"]
    address = ("--address", "https://study.example.org/studies/one/")
    s3_store.origins = ["https://study.example.org"]
    place = (f"s3://{BUCKET}/a", "--endpoint", s3_store.endpoint)
    first = run("publish-media", tiny_study, *place, *address)
    again = run("publish-media", tiny_study)

    assert "Uploaded 32 copies; 0 were already there." in first
    assert "Pages of https://study.example.org can load them" in first
    assert "Uploaded 0 copies; 32 were already there." in again
    assert SECRET not in first + again
