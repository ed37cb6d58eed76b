"""From the angles of a body to the rotations of BEAT's joints."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from training.corpus.body_angles import ARM_ANGLES, BodyAngles
from training.spaces.beat_skeleton import TOLD_JOINTS

FloatArray = NDArray[np.float64]

_COLLAR: Final = np.array([0.0, 10.0, -8.0])
"""How the left collar bone lies at rest: BEAT's arms are attached to the front of the chest."""

_HAND_AT_REST: Final = MappingProxyType(
    {
        "HandRing": (-10, 0, 0),
        "HandPinky": (-10, 0, 0),
        "HandIndex": (-7, -6, 0),
        "HandMiddle1": (2, 4, -18),
        "HandMiddle2": (0, 0, -10),
        "HandMiddle3": (0, 0, -10),
        "HandRing1": (0, 3, -18),
        "HandRing2": (0, 0, -10),
        "HandRing3": (0, 0, -10),
        "HandPinky1": (0, 10, -14),
        "HandPinky2": (0, 0, -10),
        "HandPinky3": (0, 0, -10),
        "HandIndex1": (6, 10, -16),
        "HandIndex2": (0, 0, -10),
        "HandIndex3": (0, 0, -10),
        "HandThumb1": (40, -5, 0),
        "HandThumb2": (0, 8, 0),
        "HandThumb3": (4, 6, -8),
    }
)
"""Angles about x, y and z of the left hand's joints, in degrees, as BEAT's speakers have them."""

_BENT: Final = MappingProxyType({"1": 1.0, "2": 1.1, "3": 0.8})
"""How much of a finger's curl each of its joints takes."""

_NECK_SHARE: Final = 0.55
"""Of the head's angles, in the lower of the two joints that BEAT's prepared files tell."""


def told_rotations(angles: BodyAngles) -> FloatArray:
    """Return the rotations of BEAT's told joints.

    Parameters
    ----------
    angles : BodyAngles
        T frames.

    Returns
    -------
    ndarray, shape (T, 141)
        Axis-angle in radians, in the order of `training.spaces.beat_skeleton.TOLD_JOINTS`.
    """
    turns = {
        "Spine": _bent_forward(angles.trunk),
        "Neck": _bent_forward(_NECK_SHARE * angles.head),
        "Neck1": _bent_forward((1 - _NECK_SHARE) * angles.head),
    }
    for index, side in enumerate(("Right", "Left")):
        for joint, turn in _left_arm(angles.arms[:, index]).items():
            # A turn seen in a mirror keeps its part about x and reverses the others.
            mirror = (1, -1, -1) if side == "Right" else (1, 1, 1)
            turns[f"{side}{joint}"] = turn * np.array(mirror)
    return np.concatenate([turns[name] for name in TOLD_JOINTS], axis=1)


def _bent_forward(angles: FloatArray) -> FloatArray:
    """Return the turn (T, 3) of trunk or neck: forward, to the left, tilted to the left."""
    return _turn(angles * np.array([1, 1, -1]))


def _turn(angles: FloatArray) -> FloatArray:
    """Return the rotation vectors of angles about x, y and z (T, 3) in degrees."""
    return np.asarray(Rotation.from_euler("XYZ", angles, degrees=True).as_rotvec())


def _left_arm(arm: FloatArray) -> dict[str, FloatArray]:
    """Return the turns (T, 3) of a left arm's joints; `arm` is (T, 8).

    Unturned the arm is level and the palm down. Lowered, the elbow bends to the front and the palm
    faces inward.
    """
    lift, spread, turn, bend, roll, wrist, curl, shrug = (
        arm[:, index] for index in range(len(ARM_ANGLES))
    )
    nothing = np.zeros(len(arm))
    # About x, z and x in turn: forward, down from level, and about the upper arm itself.
    upper = Rotation.from_euler("XZX", np.stack([-lift, spread - 90, turn], axis=1), degrees=True)
    turns = {
        "Shoulder": _turn(_COLLAR + np.stack([nothing, nothing, shrug], axis=1)),
        "Arm": np.asarray(upper.as_rotvec()),
        "ForeArm": np.asarray(
            Rotation.from_euler("YX", np.stack([-bend, roll], axis=1), degrees=True).as_rotvec()
        ),
        "Hand": _turn(np.stack([nothing, nothing, wrist], axis=1)),
    }
    for joint, rest in _HAND_AT_REST.items():
        own = np.tile(np.array(rest, np.float64), (len(arm), 1))
        if "Thumb" not in joint:
            own[:, 2] -= _BENT.get(joint[-1], 0.0) * curl
        turns[joint] = _turn(own)
    return turns
