"""A clip's joints on the default body: which ones metrics measure, where they are, how often."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.clip import MotionClip
from motion.placement import stand_on_ground
from motion.resample import resample
from motion.skeleton import (
    JOINT_COUNT,
    LEFT_HAND_JOINTS,
    REST_JOINTS,
    RIGHT_HAND_JOINTS,
    forward_kinematics,
    joint_index,
)

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


@dataclass(frozen=True, kw_only=True, eq=False)
class JointMotion:
    """The joint positions of one clip.

    Attributes
    ----------
    relative : ndarray, shape (T, 55, 3), float64
        Positions relative to the pelvis in metres, y up.
    pelvis : ndarray, shape (T, 3), float64
        Pelvis positions in the world, in metres, with the feet on the ground as in videos.
        All values are of single precision, whether they were computed or read.
    """

    relative: FloatArray
    pelvis: FloatArray

    @classmethod
    def of(cls, packed: NDArray[np.float32]) -> JointMotion:
        """Return what `packed_joints` packed."""
        values = packed.astype(np.float64)
        return cls(relative=values[:, :JOINT_COUNT], pelvis=values[:, JOINT_COUNT])


def joint_motion(clip: MotionClip, frame_rate: float) -> JointMotion:
    """Return where all joints are, on the default body, whatever the clip's own shape.

    Parameters
    ----------
    clip : MotionClip
        Any frame rate.
    frame_rate : float
        Frames per second of the result.
    """
    return JointMotion.of(packed_joints(clip, frame_rate))


def packed_joints(clip: MotionClip, frame_rate: float) -> NDArray[np.float32]:
    """Return a `joint_motion` as one array, shape (T, 56, 3): the pelvis comes last."""
    grounded = stand_on_ground(resample(clip, frame_rate), REST_JOINTS)
    relative = forward_kinematics(grounded.poses, np.zeros_like(grounded.trans), REST_JOINTS)[0]
    relative -= relative[:, :1]
    pelvis = REST_JOINTS[0] + grounded.trans
    return np.concatenate([relative, pelvis[:, None]], axis=1).astype(np.float32)
