"""Which joints metrics measure, and at which frame rate clips are compared."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.skeleton import LEFT_HAND_JOINTS, RIGHT_HAND_JOINTS, joint_index

FloatArray = NDArray[np.float64]

HIGHEST_FRAME_RATE: Final = 30.0
"""Metrics look at 30 frames per second at most, whatever the clips hold."""

ARM_JOINTS: Final = (
    "left_wrist",
    "left_elbow",
    "left_shoulder",
    "right_wrist",
    "right_elbow",
    "right_shoulder",
)
"""The six joints of AMUSE's beat alignment (Chhatre et al. 2024, appendix E)."""

WRISTS: Final = ("left_wrist", "right_wrist")

UPPER_BODY_JOINTS: Final = ("neck", "head", *ARM_JOINTS)

GESTURE_JOINTS: Final = (
    "spine1",
    "spine2",
    "spine3",
    "neck",
    "head",
    *(
        f"{side}_{joint}"
        for side in ("left", "right")
        for joint in ("collar", "shoulder", "elbow", "wrist")
    ),
    *LEFT_HAND_JOINTS,
    *RIGHT_HAND_JOINTS,
)
"""Joints whose rotations make a gesture: everything above the pelvis except the face."""


def common_frame_rate(frame_rates: Collection[float]) -> float:
    """Return the rate at which clips of different rates are compared: the slowest, at most 30.

    Frames that were never recorded would have to be invented for any faster rate, and an
    interpolated frame is smooth by construction, which flatters jerk.
    """
    return min(HIGHEST_FRAME_RATE, *frame_rates)


def select(positions: FloatArray, joints: Sequence[str]) -> FloatArray:
    """Return the positions of the named joints, shape (T, len(joints), 3)."""
    return positions[:, [joint_index(name) for name in joints]]
