"""A generator that gives other clips must have another version, by which clips are cached."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from generators.interface import Generator, SpeechSegment
from generators.registry import generator_names
from motion.clip import MotionClip
from motion.segment import Segment
from tests.generators.conftest import ClipsInMemory
from tests.motion.random_clips import clip_of
from tests.support.fingerprint import fingerprint

# What each version gives, by the name and the version of the generator. Where a change is wanted,
# raise the generator's version and write its new numbers here.
GOLDEN = {
    ("rule_based", "3"): [-0.46638, 0.00504, -0.18658],
    ("mismatched", "1"): [-0.07236, -0.15761, -0.37666],
    ("static", "1"): [-0.39178, 0.00000, 0.00000],
    ("broken", "1"): [0.31685, -0.15585, -0.25683],
    ("diffsheg", "2"): [-0.47054, -0.00132, 0.03463],
    ("amuse", "1"): [0.29179, 0.09339, 0.0],
    ("s2ue", "3"): [-0.15031, -0.0014, 0.01095],
}


def waving(seconds: float) -> MotionClip:
    frames = np.arange(round(seconds * 25))
    waves = np.sin(frames[:, None, None] / 9 + np.arange(165).reshape(55, 3))
    trans = np.stack([frames / 200, frames * 0, frames / 300], axis=1)
    return clip_of(waves / 5, trans, 25, arkit=np.abs(waves.reshape(-1, 165)[:, :52]))


@pytest.mark.parametrize("name", generator_names())
def test_a_generator_that_moves_otherwise_has_another_version(
    name: str, load: Callable[[str], Generator], speak: Callable[..., SpeechSegment]
) -> None:
    names = [f"segment-{number}" for number in range(2)]
    source = ClipsInMemory(
        [
            Segment(name=name, wav="a.wav", start=0, end=4, speaker="a", emotion="neutral")
            for name in names
        ],
        {name: waving(3 + number) for number, name in enumerate(names)},
    )
    generator = load(name)

    clip = generator.generate(
        speak(names[1], 4.0, "happiness", 5), seed=3, frame_rate=30, source=source
    )

    face = np.zeros(0) if clip.arkit is None else clip.arkit
    assert fingerprint(clip.poses, clip.trans, face) == pytest.approx(
        GOLDEN[name, generator.version], abs=1e-4
    )
