"""The curves of a motion that the corpus' speech drives.

They can be computed from any motion in BEAT's format, so that
a network's motion can be compared with the process.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from motion.arrays import Floats
from training.spaces.beat import FACIAL_WEIGHTS, UPPER_BODY_JOINTS, upper_body_motion

_CENTIMETRES: Final = 100.0
_BROWS: Final = ("InnerUp", "OuterUpLeft", "OuterUpRight")


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionCurves:
    """Five curves of a motion, each of shape (T,).

    Attributes
    ----------
    wrist_speed : ndarray
        Mean speed of both wrists in metres per second.
    hand_height : ndarray
        Mean height of both wrists above the hips in metres.
    head_down : ndarray
        Angle in degrees by which the chin is lowered towards the trunk.
    jaw_open, brows_up : ndarray
        Weight of the jaw and mean weight of the brows, in [0, 1].
    """

    wrist_speed: Floats
    hand_height: Floats
    head_down: Floats
    jaw_open: Floats
    brows_up: Floats


def curves_of(body: Floats, face: Floats, frame_rate: float) -> MotionCurves:
    """Return the curves of a motion.

    Parameters
    ----------
    body : ndarray, shape (T, 141)
        Axis-angle in radians of BEAT's 47 joints.
    face : ndarray, shape (T, 51)
        ARKit weights.
    frame_rate : float
        Frames per second of both.
    """
    wrists = wrist_positions(body)
    neck = body.reshape(len(body), len(UPPER_BODY_JOINTS), 3)[:, 1:3]
    lower, upper = (Rotation.from_rotvec(neck[:, joint]) for joint in (0, 1))
    forward = (lower * upper).apply([0, 0, 1])
    brows = [FACIAL_WEIGHTS.index(f"brow{name}") for name in _BROWS]
    return MotionCurves(
        wrist_speed=mean_speed(wrists, frame_rate),
        hand_height=wrists[:, :, 1].mean(axis=1),
        head_down=-np.degrees(np.arcsin(np.clip(forward[:, 1], -1, 1))),
        jaw_open=face[:, FACIAL_WEIGHTS.index("jawOpen")],
        brows_up=face[:, brows].mean(axis=1),
    )


def wrist_positions(body: Floats) -> Floats:
    """Return positions of the right and the left wrist relative to the hips, (T, 2, 3), in metres.

    The figure is the idealised one, with its hips fixed at the origin.
    """
    motion = upper_body_motion(body, 1.0)
    positions, _ = motion.forward_kinematics()
    wrists = [motion.joint_names.index(f"{side}Hand") for side in ("Right", "Left")]
    return positions[:, wrists] / _CENTIMETRES


def mean_speed(positions: Floats, frame_rate: float) -> Floats:
    """Return the speed (T,) of points (T, N, 3), averaged over points; 0 for a single frame."""
    if len(positions) < 2:
        return np.zeros(len(positions))
    velocity = np.gradient(positions, axis=0) * frame_rate
    return np.asarray(np.linalg.norm(velocity, axis=2).mean(axis=1))
