"""From speech to a clip."""

import hashlib
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from generators.diffsheg.generate import DiffSheg
from generators.diffsheg.network_file import MotionNetwork, write_network
from generators.interface import SpeechSegment
from generators.learned_settings import DiffShegSettings
from motion.audio import write_wav
from motion.clip import MotionClip
from motion.errors import InputError
from motion.skeleton import joint_index
from tests.generators.conftest import spoken
from tests.generators.diffsheg.small_network import small, small_network, written_network
from training.speakers import Speakers
from training.speech_features.hubert import stand_in


def made(checkpoint: Path, speech: SpeechSegment, **settings: Any) -> MotionClip:
    generator = DiffSheg(DiffShegSettings(checkpoint=checkpoint, **settings))
    return generator.generate(speech, seed=3, frame_rate=15)


def test_the_provenance_names_network_sampling_and_stand_ins(tmp_path: Path) -> None:
    progress: list[tuple[int, int]] = []
    model = DiffShegSettings(
        checkpoint=written_network(tmp_path / "small.safetensors"),
        speaker=2,
        sampling="plain",
        steps=10,
        overlap=6,
    )
    clip = DiffSheg(model).generate(
        spoken("one", 6.0), seed=3, frame_rate=30, on_part=lambda *far: progress.append(far)
    )
    assert progress == [(28, 90), (56, 90), (84, 90), (90, 90)]
    facts = clip.provenance
    assert facts["checkpoint_sha256"] == hashlib.sha256(model.checkpoint.read_bytes()).hexdigest()
    assert facts["checkpoint"] == "small.safetensors"
    assert facts["dataset"] == "beat"
    assert facts["speaker"] == "2"
    assert facts["sampling"].startswith("10 steps, overlap 6, entry 6, jump length 3, jump count 1")
    assert "windows of 34 frames at 15 fps" in facts["config"]
    assert "stand-in for HuBERT" in facts["stand_ins"]
    windows = [facts[f"window_{name}"] for name in ("frames", "overlap", "frame_rate")]
    assert windows == ["34", "6", "15"]


@pytest.mark.parametrize(("dataset", "overlap"), [("beat", 6), ("show", 15)])
def test_face_and_body_move_and_hips_and_legs_stand_still(
    dataset: str, overlap: int, tmp_path: Path
) -> None:
    checkpoint = written_network(tmp_path / "small.safetensors", dataset)
    clip = made(checkpoint, spoken("one", 2.0))
    moves = np.ptp(clip.poses, axis=0).max(axis=1)
    assert all(moves[joint_index(name)] > 0 for name in ("head", "left_wrist", "right_thumb1"))
    legs = ("pelvis", "left_hip", "right_knee", "left_ankle")
    assert all(moves[joint_index(name)] == 0 for name in legs)
    face, none = clip.arkit, clip.expressions
    if dataset == "show":
        face, none = none, face
        assert "relaxed hands" in clip.provenance["stand_ins"]
    assert none is None
    assert face is not None
    assert np.ptp(face, axis=0).max() > 0
    assert f"overlap {overlap}," in clip.provenance["sampling"]


def test_without_a_named_speaker_the_segments_speaker_is_used(tmp_path: Path) -> None:
    speakers = Speakers(("ada", "bo"), small("beat").speakers)
    network = replace(small_network(), speakers=speakers, hubert=stand_in().identity)
    named = tmp_path / "named.safetensors"
    write_network(named, network)
    clips = [made(named, spoken("one", 1.0, speaker=name)) for name in ("ada", "bo")]
    assert [clip.provenance["speaker"] for clip in clips] == ["ada", "bo"]
    assert (clips[0].poses != clips[1].poses).any()
    assert "speaker" not in clips[0].provenance["stand_ins"]
    stranger = made(named, spoken("one", 1.0)).provenance
    assert f"speaker {stranger['speaker']} in place of the segment's" in stranger["stand_ins"]


def diverged() -> MotionNetwork:
    network = small_network()
    for weight in network.model.parameters():
        weight.fill_(float("nan"))
    return network


@pytest.mark.parametrize(
    ("network", "changes", "message"),
    [
        (replace(small_network(), hubert="sha256 of another"), {}, "features of sha256 of another"),
        (small_network(), {"speaker": 31}, "no speaker '31'.*from 1 to 30"),
        (diverged(), {}, "not finite"),
    ],
    ids=["another hubert", "unknown speaker", "diverged"],
)
def test_a_network_that_cannot_be_used_is_refused(
    network: MotionNetwork, changes: dict[str, object], message: str, tmp_path: Path
) -> None:
    write_network(tmp_path / "other.safetensors", network)
    with pytest.raises(InputError, match=message):
        made(tmp_path / "other.safetensors", spoken("one", 1.0), **changes)


@pytest.mark.parametrize("dataset", ["beat", "show"])
def test_streamed_clips_do_not_depend_on_the_division_of_the_speech(
    dataset: str, tmp_path: Path
) -> None:
    checkpoint = written_network(tmp_path / "small.safetensors", dataset)
    generator = DiffSheg(DiffShegSettings(checkpoint=checkpoint))
    samples = spoken("one", 7.3).audio.samples
    pieces, few = (
        list(generator.stream_clips(np.array_split(samples, count), seed=3)) for count in (50, 1)
    )
    assert len(pieces) > 2
    face = "arkit" if dataset == "beat" else "expressions"
    for channel in ("poses", "trans", face):
        joined, whole = (
            np.concatenate([getattr(clip, channel) for clip in clips]) for clips in (pieces, few)
        )
        np.testing.assert_array_equal(joined, whole)
    assert pieces[0].provenance["heard"] == "1 s at once with 4 s before and 1 s ahead"
    assert pieces[0].provenance["seed"] == "3"


PAGE = Path(__file__).parents[3] / "docs" / "diffsheg.md"


def test_the_documented_example_of_streaming_works(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (example,) = re.findall(r"```python\n([^`]*stream_clips[^`]*)```", PAGE.read_text("utf-8"))
    written_network(tmp_path / "tiny.safetensors")
    write_wav(tmp_path / "hello.wav", spoken("hello", 5.0).audio)
    monkeypatch.chdir(tmp_path)
    exec(compile(example, str(PAGE), "exec"), {})  # noqa: S102 - it is our own page
    assert capsys.readouterr().out.splitlines() == [
        "1.9 s: body (28, 55, 3), face (28, 52)",
        "1.9 s: body (28, 55, 3), face (28, 52)",
        "1.3 s: body (19, 55, 3), face (19, 52)",
    ]


@pytest.mark.parametrize(
    ("changes", "message"),
    [({"steps": 30}, "30 steps do not divide"), ({"speaker": 0}, "speaker's number, from 1")],
)
def test_settings_that_no_network_can_have_are_refused(
    changes: dict[str, int], message: str
) -> None:
    with pytest.raises(ValidationError, match=message):
        DiffShegSettings.model_validate({"checkpoint": Path("a.pt"), **changes})
