"""Joint positions that metrics measure: every clip on the same body, at the same frame rate."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.clip import MotionClip
from motion.freeze import freeze
from motion.resample import resample
from motion.rest_pose import REST_JOINTS
from motion.skeleton import forward_kinematics, joint_index

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


def common_frame_rate(frame_rates: Collection[float]) -> float:
    """Return the rate at which clips of different rates are compared: the slowest, at most 30.

    Frames that were never recorded would have to be invented for any faster rate, and an
    interpolated frame is smooth by construction, which flatters jerk.
    """
    return min(HIGHEST_FRAME_RATE, *frame_rates)


def joint_positions(
    clip: MotionClip, frame_rate: float, frozen: Collection[str] = ()
) -> FloatArray:
    """Return where all joints are, on the default body, whatever the clip's own shape.

    Parameters
    ----------
    clip : MotionClip
        Any frame rate.
    frame_rate : float
        Frames per second of the result.
    frozen : collection of str
        Channels that the study holds still in its videos (`motion.freeze`).

    Returns
    -------
    ndarray, shape (T, 55, 3)
        Positions in metres relative to the pelvis, y up.
    """
    seen = freeze(resample(clip, frame_rate), frozen)
    positions = forward_kinematics(seen.poses, np.zeros_like(seen.trans), REST_JOINTS)[0]
    return positions - positions[:, :1]


def select(positions: FloatArray, joints: Sequence[str]) -> FloatArray:
    """Return the positions of the named joints, shape (T, len(joints), 3)."""
    return positions[:, [joint_index(name) for name in joints]]
