"""What every registered generator promises."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from generators.interface import Generator, SpeechSegment, StudyClips
from generators.registry import generator_names, needs_model
from motion.clip import MotionClip
from motion.errors import InputError
from motion.skeleton import JOINT_NAMES

Speak = Callable[..., SpeechSegment]
Load = Callable[[str], Generator]

LARGEST_TURN = {
    "pelvis": 25, "spine": 20, "neck": 35, "head": 40, "collar": 30, "shoulder": 130,
    "elbow": 155, "wrist": 90, "hip": 40, "knee": 60, "ankle": 40, "foot": 5, "jaw": 30,
    "eye": 40, "thumb": 70, "index": 105, "middle": 105, "ring": 105, "pinky": 105,
}  # fmt: skip
"""Degrees by which a standing speaker may turn each kind of joint away from the T-pose."""


@pytest.fixture(scope="module", params=generator_names())
def generator(request: pytest.FixtureRequest, load: Load) -> Generator:
    return load(request.param)


def make(
    generator: Generator,
    study: StudyClips,
    speech: SpeechSegment,
    *,
    seed: int = 1,
    frame_rate: float = 30.0,
) -> MotionClip:
    return generator.generate(speech, source=study, seed=seed, frame_rate=frame_rate)


@pytest.fixture(scope="module")
def speech(study: StudyClips, speak: Speak) -> SpeechSegment:
    return speak(study.segments[1].name, 5.0, "happiness", 1)


@pytest.fixture(scope="module")
def clip(generator: Generator, study: StudyClips, speech: SpeechSegment) -> MotionClip:
    return make(generator, study, speech)


def test_it_is_registered_under_its_own_name(load: Load) -> None:
    assert [load(name).name for name in generator_names()] == list(generator_names())


@pytest.mark.parametrize(("frame_rate", "seconds"), [(15.0, 2.0), (29.97, 3.217), (60.0, 7.5)])
def test_the_clip_has_as_many_frames_as_the_speech(
    generator: Generator, study: StudyClips, speak: Speak, frame_rate: float, seconds: float
) -> None:
    speech = speak(study.segments[1].name, seconds)
    clip = make(generator, study, speech, frame_rate=frame_rate)
    assert len(clip) == round(speech.audio.duration * frame_rate)
    assert clip.frame_rate == frame_rate


def test_the_same_seed_gives_the_same_bytes(
    generator: Generator, study: StudyClips, speech: SpeechSegment, clip: MotionClip
) -> None:
    first, second = clip, make(generator, study, speech)
    assert first.poses.tobytes() == second.poses.tobytes()
    assert first.trans.tobytes() == second.trans.tobytes()
    assert (first.arkit is None) == (second.arkit is None)
    if first.arkit is not None and second.arkit is not None:
        assert first.arkit.tobytes() == second.arkit.tobytes()
    assert first.provenance == second.provenance


def test_another_seed_gives_another_clip_where_chance_plays(
    generator: Generator, study: StudyClips, speech: SpeechSegment, clip: MotionClip
) -> None:
    others = (make(generator, study, speech, seed=seed).poses for seed in range(2, 9))
    differ = any(poses.tobytes() != clip.poses.tobytes() for poses in others)
    assert differ == (generator.name != "static")


def test_facial_actions_are_weights(generator: Generator, clip: MotionClip) -> None:
    if generator.name == "amuse":
        assert clip.arkit is None  # It moves no face.
        return
    assert clip.arkit is not None
    assert clip.arkit.min() >= 0
    assert clip.arkit.max() <= 1


def test_the_clip_says_where_it_comes_from(
    generator: Generator, speech: SpeechSegment, clip: MotionClip
) -> None:
    facts = clip.provenance
    assert facts["generator"] == generator.name
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


def test_a_generator_that_needs_a_source_says_so(
    generator: Generator, speech: SpeechSegment
) -> None:
    if not generator.needs_source:
        generator.generate(speech, seed=1, frame_rate=30)
        return
    with pytest.raises(InputError, match="source"):
        generator.generate(speech, seed=1, frame_rate=30)


def test_a_negative_seed_is_refused(
    generator: Generator, study: StudyClips, speech: SpeechSegment
) -> None:
    with pytest.raises(InputError, match="seed"):
        make(generator, study, speech, seed=-1)


@pytest.mark.parametrize("frame_rate", [0.0, -30.0, 0.1])
def test_a_frame_rate_that_gives_no_frame_is_refused(
    generator: Generator, study: StudyClips, speech: SpeechSegment, frame_rate: float
) -> None:
    with pytest.raises(InputError, match=r"frame rate|shorter than one frame"):
        make(generator, study, speech, frame_rate=frame_rate)
