"""From speech to a clip."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from generators.diffsheg.beat_motion import beat_clip
from generators.diffsheg.generator import DiffSheg
from generators.diffsheg.listening import HearingWindow
from generators.diffsheg.network_file import write_network
from generators.diffsheg.walk import Sampling
from generators.interface import SpeechSegment
from generators.model_settings import ModelSettings
from motion.errors import InputError
from motion.skeleton import joint_index
from tests.generators.diffsheg.small_network import small_network, written_network

Speak = Callable[..., SpeechSegment]


@pytest.fixture
def model(tmp_path: Path) -> ModelSettings:
    return ModelSettings(checkpoint=written_network(tmp_path / "small.safetensors"))


def test_a_clip_says_what_made_it_and_what_stood_in(model: ModelSettings, speak: Speak) -> None:
    clip = DiffSheg(replace(model, speaker=2)).generate(speak("one", 2.0), seed=3, frame_rate=30)
    facts = clip.provenance
    assert facts["checkpoint_sha256"] == hashlib.sha256(model.checkpoint.read_bytes()).hexdigest()
    assert facts["checkpoint"] == "small.safetensors"
    assert facts["dataset"] == "beat"
    assert facts["speaker"] == "2"
    assert "25 steps, overlap 4" in facts["sampling"]
    assert "windows of 34 frames at 15 fps" in facts["config"]
    assert "stand-in for HuBERT" in facts["stand_ins"]


def test_face_and_body_move_and_hips_and_legs_stand_still(
    model: ModelSettings, speak: Speak
) -> None:
    clip = DiffSheg(model).generate(speak("one", 2.0), seed=3, frame_rate=30)
    moves = np.ptp(clip.poses, axis=0).max(axis=1)
    assert all(moves[joint_index(name)] > 0 for name in ("head", "left_wrist", "right_thumb1"))
    legs = ("pelvis", "left_hip", "right_knee", "left_ankle")
    assert all(moves[joint_index(name)] == 0 for name in legs)
    assert clip.arkit is not None
    assert np.ptp(clip.arkit, axis=0).max() > 0


def test_a_network_of_show_moves_jaw_and_expressions(tmp_path: Path, speak: Speak) -> None:
    checkpoint = written_network(tmp_path / "show.safetensors", "show")
    clip = DiffSheg(ModelSettings(checkpoint=checkpoint)).generate(
        speak("one", 2.0), seed=3, frame_rate=30
    )
    assert clip.arkit is None
    assert clip.expressions is not None
    assert np.ptp(clip.expressions, axis=0).min() > 0
    assert "overlap 10" in clip.provenance["sampling"]
    assert "relaxed hands" in clip.provenance["stand_ins"]


def test_the_speech_decides_the_motion(model: ModelSettings, speak: Speak) -> None:
    clips = [
        DiffSheg(model).generate(speak("one", 2.0, "neutral", number), seed=3, frame_rate=15)
        for number in range(2)
    ]
    assert (clips[0].poses != clips[1].poses).any()


def test_sampling_can_be_chosen_and_is_quoted(model: ModelSettings, speak: Speak) -> None:
    sampling = Sampling(steps=10, entry=6, overlap=2, jump_count=1)
    clip = DiffSheg(model, sampling).generate(speak("one", 1.0), seed=3, frame_rate=15)
    assert clip.provenance["sampling"].startswith("10 steps, overlap 2, entry 6")


def test_a_speaker_whom_the_network_does_not_know_is_refused(
    model: ModelSettings, speak: Speak
) -> None:
    with pytest.raises(InputError, match="no speaker 31") as refusal:
        DiffSheg(replace(model, speaker=31)).generate(speak("one", 1.0), seed=3, frame_rate=15)
    assert "from 1 to 30" in str(refusal.value.remedy)


def test_a_folder_without_hubert_is_refused_before_anything_is_made(
    model: ModelSettings, tmp_path: Path
) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=r"holds no config\.json"):
        DiffSheg(replace(model, hubert=tmp_path / "empty"))


def test_a_network_whose_motion_is_not_finite_is_refused(tmp_path: Path, speak: Speak) -> None:
    network = small_network()
    for weight in network.denoiser.parameters():
        weight.fill_(float("nan"))
    write_network(tmp_path / "diverged.safetensors", network)
    model = ModelSettings(checkpoint=tmp_path / "diverged.safetensors")
    with pytest.raises(InputError, match="not finite"):
        DiffSheg(model).generate(speak("one", 1.0), seed=3, frame_rate=15)


def test_motion_comes_while_somebody_speaks_and_is_that_of_all_speech_at_once(
    model: ModelSettings, speak: Speak
) -> None:
    samples = speak("one", 6.3).audio.samples
    heard: list[int] = []

    def pieces() -> Iterator[np.ndarray]:
        for piece in np.array_split(samples, 50):
            heard.append(len(piece))
            yield piece

    generator = DiffSheg(model)
    window = HearingWindow(past=1, ahead=0.5)
    streamed = generator.stream(pieces(), seed=3, window=window)
    first = next(streamed)
    # A window of 34 frames lies within three seconds, of which the last looks half a one ahead.
    assert sum(heard) / 16000 < 3.5 + 6.3 / 50
    assert len(first) == 30
    motion = np.concatenate([first, *streamed])
    assert len(motion) == round(6.3 * 15)
    whole = np.concatenate(list(generator.stream([samples], seed=3, window=window)))
    np.testing.assert_array_equal(motion, whole)
    assert len(beat_clip(motion, 15)) == len(motion)


def test_speech_of_less_than_a_frame_of_the_network_gives_a_clip(
    model: ModelSettings, speak: Speak
) -> None:
    speech = speak("one", 1.0)
    short = replace(speech, audio=speech.audio.cut(0, 0.02))
    assert len(DiffSheg(model).generate(short, seed=3, frame_rate=60)) == 1
