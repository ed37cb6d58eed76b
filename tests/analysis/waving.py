"""Clips whose arms swing."""

import numpy as np

from motion.clip import MotionClip
from motion.skeleton import JOINT_COUNT, joint_index
from tests.motion.random_clips import clip_of


def waving(
    *,
    frequency: float = 1.0,
    seconds: float = 4.0,
    frame_rate: float = 30.0,
    amplitude: float = 0.6,
    drift: float = 0.0,
) -> MotionClip:
    """Return a clip whose arms swing at a rate, of a body that moves at a speed along x."""
    time = np.arange(round(seconds * frame_rate)) / frame_rate
    poses = np.zeros((len(time), JOINT_COUNT, 3))
    swinging = [joint_index("left_shoulder"), joint_index("right_shoulder")]
    poses[:, swinging, 2] = amplitude * np.sin(2 * np.pi * frequency * time)[:, None]
    return clip_of(poses, np.outer(drift * time, [1.0, 0.0, 0.0]), frame_rate)
