from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion.audio import Audio, write_wav
from motion.clip import MotionClip
from motion.formats import read_clip, write_clip
from studyapp.study.study_file import new_study
from tests.generators.diffsheg.small_network import written_network
from tests.support.command_line import refused, run


@pytest.fixture
def speech(tmp_path: Path) -> Path:
    path = tmp_path / "hello.wav"
    times = np.arange(16_000) / 16_000
    write_wav(path, Audio((0.3 * np.sin(2 * np.pi * 150 * times)).astype(np.float32), 16_000))
    return path


@pytest.fixture
def checkpoint(tmp_path: Path) -> Path:
    return written_network(tmp_path / "small.safetensors")


def test_a_network_moves_to_a_recording_without_a_study_and_names_what_stood_in(
    speech: Path, checkpoint: Path, tmp_path: Path
) -> None:
    options = ("--generator", "diffsheg", "--checkpoint", checkpoint, "--speech", speech)
    said = run("generate", *options, "--out", tmp_path / "out", "--fps", 25, "--seed", 4)
    assert "Generated 1 clip," in said
    assert "Stands in for something real: diffsheg: stand-in for HuBERT" in said
    clip = read_clip(tmp_path / "out" / "hello.npz")
    assert (len(clip), clip.frame_rate) == (25, 25)
    assert clip.provenance["seed"] == "4"
    again = run("generate", *options, "--out", tmp_path / "out", "--fps", 25, "--seed", 4)
    assert "Generated 0 clips, kept 1" in again
    assert "Stands in" in again
    other = run("generate", *options, "--out", tmp_path / "out", "--fps", 25, "--seed", 5)
    assert "Generated 1 clip," in other


def test_a_generator_without_weights_moves_too(speech: Path, tmp_path: Path) -> None:
    said = run("generate", "--generator", "static", "--speech", speech, "--out", tmp_path)
    assert said.count("Stands in") == 0
    assert len(read_clip(tmp_path / "hello.npz")) == 30


def test_motion_that_was_made_elsewhere_is_never_written_over(speech: Path, tmp_path: Path) -> None:
    clip = MotionClip(
        poses=np.zeros((3, 55, 3), np.float32), trans=np.zeros((3, 3), np.float32), frame_rate=30
    )
    write_clip(tmp_path / "hello.npz", clip)
    before = (tmp_path / "hello.npz").read_bytes()
    said = run("generate", "--generator", "static", "--speech", speech, "--out", tmp_path, status=1)
    assert "made elsewhere" in said
    assert (tmp_path / "hello.npz").read_bytes() == before


def test_two_recordings_of_one_name_are_refused(speech: Path, tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    other = speech.rename(tmp_path / "other" / "hello.wav")
    speech.write_bytes(other.read_bytes())
    both = ("--speech", speech, "--speech", other)
    said = refused("generate", "--generator", "static", *both, "--out", tmp_path)
    assert "two files of speech are called 'hello'" in said


@pytest.mark.parametrize("options", [(), ("--generator", "static")])
def test_less_than_a_study_or_generator_speech_and_out_is_refused(options: tuple[str, ...]) -> None:
    said = run("generate", *options, status=1)
    assert "neither a study nor all of --generator, --speech and --out" in said


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (("diffsheg",), "generator 'diffsheg' needs a checkpoint"),
        (("broken",), "changes another condition's motion"),
    ],
)
def test_what_does_not_fit_together_is_refused_in_one_sentence(
    speech: Path, tmp_path: Path, options: tuple[object, ...], what: str
) -> None:
    given = ("--speech", speech, "--out", tmp_path / "out")
    assert what in run("generate", *given, "--generator", *options, status=1)


def test_a_study_takes_no_options_of_single_recordings(speech: Path, tmp_path: Path) -> None:
    new_study(tmp_path / "study" / "study.toml", name="study")
    said = run("generate", tmp_path / "study", "--generator", "static", status=1)
    assert "a study says itself how its conditions move" in said
