"""Hands at rest, and fingers that are told relative to SMPL-X's mean hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.body.archive import body_archive
from motion.clip import MotionClip
from motion.skeleton import LEFT_HAND_JOINTS, joint_index

FloatArray = NDArray[np.float32]

_FINGERS_COUNT: Final = 2 * len(LEFT_HAND_JOINTS)
_LEFT: Final = slice(joint_index("left_index1"), joint_index("left_index1") + 15)
_RIGHT: Final = slice(joint_index("right_index1"), joint_index("right_index1") + 15)
FINGERS: Final = slice(_LEFT.start, _RIGHT.stop)
"""Where the finger joints are among the 55."""

_BENT: Final = {
    "index": (0.30, 0.44, 0.25),
    "middle": (0.34, 0.50, 0.28),
    "pinky": (0.42, 0.52, 0.30),
    "ring": (0.38, 0.54, 0.30),
}
"""Radians by which the three joints of each finger of a relaxed hand bend."""

_TOGETHER: Final = {"index": 0.09, "middle": -0.05, "pinky": -0.17, "ring": -0.12}
"""Radians by which each left finger turns about y towards the others; at rest they are spread."""

_THUMB: Final = ((-0.02, 0.26, 0.29), (0.05, 0.10, -0.05), (0.05, 0.10, -0.05))
"""Rotations of the left thumb's joints, axis-angle in radians: beside the index finger."""

_MEAN_HANDS: Final = ("hands_meanl", "hands_meanr")


def _relaxed_hands() -> FloatArray:
    # With the arms out and the palms down, fingers bend about z: left ones turn downwards with a
    # negative angle, right ones, as their mirror images, with a positive one.
    left = np.zeros((len(LEFT_HAND_JOINTS), 3), np.float32)
    for number, name in enumerate(LEFT_HAND_JOINTS):
        finger, phalanx = name.removeprefix("left_")[:-1], int(name[-1]) - 1
        if finger == "thumb":
            left[number] = _THUMB[phalanx]
        else:
            left[number] = (0, 0 if phalanx else _TOGETHER[finger], -_BENT[finger][phalanx])
    hands = np.concatenate([left, left * [1, -1, -1]]).astype(np.float32)
    hands.setflags(write=False)
    return hands


RELAXED_HANDS: Final = _relaxed_hands()
"""Shape (30, 3): the finger joints of both hands at rest, axis-angle in radians."""


def read_mean_hands(body: Path) -> FloatArray | None:
    """Return the mean hands of an SMPL-X model file, shape (30, 3); None where it has none.

    Raises
    ------
    InputError
        If the file is missing or cannot be read.
    """
    with body_archive(body) as archive:
        if any(name not in archive for name in _MEAN_HANDS):
            return None
        both = np.concatenate([archive[name].reshape(-1) for name in _MEAN_HANDS])
    if both.size != _FINGERS_COUNT * 3 or not both.any():
        return None
    return both.reshape(_FINGERS_COUNT, 3).astype(np.float32)


def added_to_mean_hands(clip: MotionClip, mean_hands: FloatArray) -> MotionClip:
    """Return `clip`, whose fingers are told relative to mean hands, with absolute fingers.

    Parameters
    ----------
    clip : MotionClip
        Its finger rotations are zero where the hands are the mean ones, as in a model that was
        created with ``flat_hand_mean=False``.
    mean_hands : ndarray, shape (30, 3)
        Axis-angle in radians; added to the clip's as SMPL-X adds them.
    """
    poses = clip.poses.copy()
    poses[:, FINGERS] += mean_hands
    return replace(clip, poses=poses)
