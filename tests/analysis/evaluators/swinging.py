"""Clips whose emotion is the speed and width of the arms' swing, with a moving face."""

from collections.abc import Mapping

import numpy as np

from analysis.evaluators.training import ClipSource
from motion.clip import MotionClip
from motion.skeleton import joint_index
from tests.motion.random_clips import clip_of

SWINGS: Mapping[str, tuple[float, float]] = {"anger": (2.0, 0.9), "sadness": (0.5, 0.3)}
"""Swings a second, and radians."""


def swinging(
    emotion: str, seed: int, *, seconds: float = 8.0, frame_rate: float = 30.0
) -> MotionClip:
    chance = np.random.default_rng(seed)
    frames = round(seconds * frame_rate)
    rate, reach = SWINGS[emotion]
    turn = 2 * np.pi * (rate * np.arange(frames) / frame_rate + chance.random())
    poses = chance.normal(0, 0.001, (frames, 55, 3))
    for joint, part in (("left_shoulder", 1.0), ("right_shoulder", -1.0), ("left_elbow", 0.5)):
        poses[:, joint_index(joint), 2] += part * reach * np.sin(turn)
    arkit = np.zeros((frames, 52), np.float32)
    arkit[:, 24] = 0.5 + 0.4 * np.sin(3 * turn)
    arkit[:, 43] = arkit[:, 44] = 0.5 + 0.4 * np.sin(turn)
    return clip_of(poses, frame_rate=frame_rate, arkit=arkit)


def source(emotion: str, seed: int, **options: float) -> ClipSource:
    name = f"{emotion}-{seed}"
    return ClipSource(
        name=name,
        recording=name,
        emotion=emotion,
        sha256=f"{seed:064x}",
        read=lambda: swinging(emotion, seed, **options),
    )


def sources(each: int = 5) -> tuple[ClipSource, ...]:
    return tuple(source(emotion, seed) for emotion in SWINGS for seed in range(each))
