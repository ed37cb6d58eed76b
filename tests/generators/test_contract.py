"""The contract of every registered generator."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from generators.interface import (
    Generator,
    SpeechSegment,
    StudyClips,
    with_length,
)
from generators.registry import generator_names, load_generator, needs_model, needs_source
from motion.audio import Audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.segment import EMOTIONS
from motion.skeleton import JOINT_NAMES
from tests.motion.random_clips import clip_of

Speak = Callable[..., SpeechSegment]
Load = Callable[[str], Generator]
Made = Callable[..., MotionClip]

LARGEST_TURN = {
    "pelvis": 25, "spine": 20, "neck": 35, "head": 40, "collar": 30, "shoulder": 130,
    "elbow": 155, "wrist": 90, "hip": 40, "knee": 60, "ankle": 40, "foot": 5, "jaw": 30,
    "eye": 40, "thumb": 70, "index": 105, "middle": 105, "ring": 105, "pinky": 105,
}  # fmt: skip
"""Degrees by which a standing speaker may turn each kind of joint away from the T-pose."""


@pytest.fixture(scope="module", params=generator_names())
def generator(request: pytest.FixtureRequest, load: Load) -> Generator:
    return load(request.param)


@pytest.fixture(scope="module")
def made(generator: Generator, study: StudyClips) -> Made:
    usual: dict[str, Any] = {"source": study, "seed": 1, "frame_rate": 30.0}
    return lambda speech, **changes: generator.generate(speech, **(usual | changes))


@pytest.fixture(scope="module")
def speech(study: StudyClips, speak: Speak) -> SpeechSegment:
    return speak(study.segments[1].name, 5.0, "happiness", 1)


@pytest.fixture(scope="module")
def clip(made: Made, speech: SpeechSegment) -> MotionClip:
    return made(speech)


@pytest.mark.parametrize(("frame_rate", "seconds"), [(15.0, 2.0), (29.97, 3.217), (60.0, 7.5)])
def test_the_clip_has_as_many_frames_as_the_speech(
    made: Made, study: StudyClips, speak: Speak, frame_rate: float, seconds: float
) -> None:
    speech = speak(study.segments[1].name, seconds)
    clip = made(speech, frame_rate=frame_rate)
    assert len(clip) == round(speech.audio.duration * frame_rate)
    assert clip.frame_rate == frame_rate


def test_the_same_seed_gives_the_same_bytes(
    made: Made, speech: SpeechSegment, clip: MotionClip
) -> None:
    first, second = clip, made(speech)
    assert first.poses.tobytes() == second.poses.tobytes()
    assert first.trans.tobytes() == second.trans.tobytes()
    assert (first.arkit is None) == (second.arkit is None)
    if first.arkit is not None and second.arkit is not None:
        assert first.arkit.tobytes() == second.arkit.tobytes()
    assert first.provenance == second.provenance


def test_another_seed_gives_another_clip_where_chance_plays(
    generator: Generator, made: Made, speech: SpeechSegment, clip: MotionClip
) -> None:
    others = (made(speech, seed=seed).poses for seed in range(2, 9))
    differ = any(poses.tobytes() != clip.poses.tobytes() for poses in others)
    assert differ == (generator.name != "static")


def test_the_clip_names_its_origin(
    request: pytest.FixtureRequest, speech: SpeechSegment, clip: MotionClip
) -> None:
    facts = clip.provenance
    assert facts["generator"] == request.node.callspec.params["generator"]
    assert facts["seed"] == "1"
    assert facts["segment"] == speech.segment.name


@pytest.mark.parametrize(
    "generator", [name for name in generator_names() if not needs_model(name)], indirect=True
)
def test_joints_stay_within_what_a_body_can_do_unless_it_is_broken(
    generator: Generator, clip: MotionClip
) -> None:
    turns = np.degrees(np.linalg.norm(clip.poses, axis=2).max(axis=0))
    kinds = [next(kind for kind in LARGEST_TURN if kind in name) for name in JOINT_NAMES]
    within = turns <= [LARGEST_TURN[kind] for kind in kinds]
    assert within.all() == (generator.name != "broken")


def test_a_generator_that_needs_a_source_refuses_to_run_without(
    generator: Generator, speech: SpeechSegment
) -> None:
    if not needs_source(generator.name):
        generator.generate(speech, seed=1, frame_rate=30)
        return
    with pytest.raises(InputError, match="source"):
        generator.generate(speech, seed=1, frame_rate=30)


def counting(frames: int) -> MotionClip:
    """A clip with distinct frames: trans holds the frame's number."""
    return clip_of(
        np.zeros((frames, 55, 3)), np.repeat(np.arange(float(frames))[:, None], 3, axis=1)
    )


@given(st.integers(1, 30), st.integers(1, 100))
def test_a_clip_is_fitted_to_any_length_without_a_jump(length: int, frames: int) -> None:
    numbers = with_length(counting(length), frames).trans[:, 0]
    assert len(numbers) == frames
    np.testing.assert_array_equal(numbers[:length], np.arange(min(length, frames)))
    assert (np.abs(np.diff(numbers)) <= 1).all()


@pytest.mark.parametrize(("samples", "rate"), [(600, 8000), (1500, 48000), (5000, 16000)])
def test_even_a_blink_of_speech_gets_its_motion(speak: Speak, samples: int, rate: int) -> None:
    noise = np.random.default_rng(0).normal(0, 0.1, samples).clip(-1, 1)
    speech = SpeechSegment(
        segment=speak("a", 1.0, EMOTIONS[2]).segment, audio=Audio(noise.astype(np.float32), rate)
    )
    frame_rate = 120.0
    clip = load_generator("rule_based").generate(speech, seed=0, frame_rate=frame_rate)
    assert len(clip) == round(samples / rate * frame_rate)
