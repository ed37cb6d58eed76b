"""The contract of every registered generator."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from generators.amuse.config import MOTION_PRESETS, SPEECH_PRESETS
from generators.diffsheg import config as diffsheg
from generators.interface import Generator, SpeechSegment, StudyClips, with_length
from generators.registry import (
    TRAINABLE,
    generator_names,
    load_generator,
    needs_model,
    needs_source,
)
from generators.s2ue import config as s2ue
from motion.audio import Audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.segment import EMOTIONS
from motion.skeleton import JOINT_NAMES
from tests.generators.conftest import ClipsInMemory, as_speech, spoken
from tests.motion.random_clips import clip_of
from tests.support.fingerprint import fingerprint

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
def speech(study: StudyClips) -> SpeechSegment:
    return spoken(study.segments[1].name, 5.0, 1, emotion="happiness")


@pytest.fixture(scope="module")
def clip(made: Made, speech: SpeechSegment) -> MotionClip:
    return made(speech)


@pytest.mark.parametrize(("frame_rate", "seconds"), [(15.0, 2.0), (29.97, 3.217), (60.0, 7.5)])
def test_the_clip_has_as_many_frames_as_the_speech(
    made: Made, study: StudyClips, frame_rate: float, seconds: float
) -> None:
    speech = spoken(study.segments[1].name, seconds)
    clip = made(speech, frame_rate=frame_rate)
    assert len(clip) == round(speech.audio.duration * frame_rate)
    assert clip.frame_rate == frame_rate


def test_the_same_seed_gives_the_same_bytes_and_the_clip_records_its_origin(
    generator: Generator, made: Made, speech: SpeechSegment, clip: MotionClip
) -> None:
    again = made(speech)
    for channel in ("poses", "trans", "arkit"):
        first, second = (getattr(each, channel) for each in (clip, again))
        assert first is second is None or first.tobytes() == second.tobytes()
    assert clip.provenance == again.provenance
    origin = {"generator": generator.name, "seed": "1", "segment": speech.segment.name}
    assert clip.provenance.items() >= origin.items()


def test_another_seed_gives_another_clip_unless_the_generator_is_deterministic(
    generator: Generator, made: Made, speech: SpeechSegment, clip: MotionClip
) -> None:
    others = (made(speech, seed=seed).poses for seed in range(2, 9))
    differ = any(poses.tobytes() != clip.poses.tobytes() for poses in others)
    assert differ == (generator.name != "static")


@pytest.mark.parametrize(
    "generator", [name for name in generator_names() if not needs_model(name)], indirect=True
)
def test_joints_stay_within_human_limits_unless_broken_on_purpose(
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


@given(st.integers(1, 30), st.integers(1, 100))
def test_a_clip_is_fitted_to_any_length_without_a_jump(length: int, frames: int) -> None:
    counted = np.repeat(np.arange(float(length))[:, None], 3, axis=1)
    clip = clip_of(np.zeros((length, 55, 3)), counted)
    numbers = with_length(clip, frames).trans[:, 0]
    assert len(numbers) == frames
    np.testing.assert_array_equal(numbers[:length], np.arange(min(length, frames)))
    assert (np.abs(np.diff(numbers)) <= 1).all()


@pytest.mark.parametrize(("samples", "rate"), [(600, 8000), (1500, 48000), (5000, 16000)])
def test_very_short_speech_gets_motion(samples: int, rate: int) -> None:
    noise = np.random.default_rng(0).normal(0, 0.1, samples).clip(-1, 1)
    speech = as_speech(Audio(noise.astype(np.float32), rate), emotion=EMOTIONS[2])
    frame_rate = 120.0
    clip = load_generator("rule_based").generate(speech, seed=0, frame_rate=frame_rate)
    assert len(clip) == round(samples / rate * frame_rate)
    for unusable in (0.0, -1.0, 0.5):
        with pytest.raises(InputError, match="shorter than one frame"):
            load_generator("rule_based").generate(speech, seed=0, frame_rate=unusable)


def test_an_unknown_generator_is_refused() -> None:
    with pytest.raises(InputError, match=r"no generator 'telepathic'.*rule_based"):
        load_generator("telepathic")


@pytest.mark.parametrize(
    ("name", "presets", "ablations"),
    [
        ("amuse", MOTION_PRESETS, None),
        ("amuse-speech", SPEECH_PRESETS, None),
        ("diffsheg", diffsheg.PRESETS, diffsheg.ABLATIONS),
        ("s2ue", s2ue.PRESETS, s2ue.ABLATIONS),
    ],
)
def test_listed_configs_and_ablations_match_the_existing_ones(
    name: str, presets: Mapping[str, object], ablations: Mapping[str, object] | None
) -> None:
    trainable = TRAINABLE[name]
    assert set(trainable.configs) == set(presets)
    (choice,) = (choice for choice in trainable.choices if choice.name == "ablation")
    assert ablations is None or choice.values == tuple(ablations)


# The output of each version, by the name and the version of the generator. After an intended
# change, raise the generator's version and write its new numbers here.
GOLDEN = {
    ("rule_based", "3"): [-0.46638, 0.00504, -0.18658],
    ("mismatched", "1"): [-0.07236, -0.15761, -0.37666],
    ("static", "1"): [-0.39178, 0.00000, 0.00000],
    ("broken", "1"): [0.31685, -0.15585, -0.25683],
    ("diffsheg", "2"): [-0.47054, -0.00132, 0.03463],
    ("amuse", "2"): [0.29179, 0.09339, 0.0],
    ("s2ue", "3"): [-0.15031, -0.0014, 0.01095],
}


def waving(seconds: float) -> MotionClip:
    frames = np.arange(round(seconds * 25))
    waves = np.sin(frames[:, None, None] / 9 + np.arange(165).reshape(55, 3))
    trans = np.stack([frames / 200, frames * 0, frames / 300], axis=1)
    return clip_of(waves / 5, trans, 25, arkit=np.abs(waves.reshape(-1, 165)[:, :52]))


@pytest.mark.parametrize("name", generator_names())
def test_changed_motion_requires_a_new_generator_version(
    name: str, load: Callable[[str], Generator]
) -> None:
    names = [f"segment-{number}" for number in range(2)]
    source = ClipsInMemory(
        [spoken(name, 4.0).segment for name in names],
        {name: waving(3 + number) for number, name in enumerate(names)},
    )
    generator, speech = load(name), spoken(names[1], 4.0, 5, emotion="happiness")

    clip = generator.generate(speech, seed=3, frame_rate=30, source=source)

    face = np.zeros(0) if clip.arkit is None else clip.arkit
    assert fingerprint(clip.poses, clip.trans, face) == pytest.approx(
        GOLDEN[name, generator.version], abs=1e-4
    )
