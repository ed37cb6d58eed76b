"""From how far fingers are curled and spread to the rotations of a hand's 15 joints."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.rule_based.hand_pose import CURLS, SPREAD

FloatArray = NDArray[np.float64]

_FIST: Final = np.radians([78.0, 95.0, 60.0])
_THUMB_CURL: Final = np.radians([[14.0, 18.0, 0.0], [0.0, 28.0, 0.0], [0.0, 45.0, 0.0]])
_SPREAD_ANGLE: Final = np.radians([12.0, 1.0, -16.0, -8.0])
_THUMB_ABDUCTION: Final = np.radians(16.0)
_FINGERS: Final = ("index", "middle", "pinky", "ring")
_CURL_ORDER: Final = ("thumb", "index", "middle", "ring", "pinky")


def finger_rotations(hand: FloatArray, sign: float) -> FloatArray:
    """Return the rotations of a hand's joints.

    Parameters
    ----------
    hand : ndarray, shape (T, 13)
        Channels of `hand_pose`.
    sign : float
        1 for the left hand, -1 for the right one.

    Returns
    -------
    ndarray, shape (T, 15, 3)
        Axis-angle in radians, in the order of `motion.skeleton.LEFT_HAND_JOINTS`: index,
        middle, pinky, ring, thumb, three joints each.
    """
    rotations = np.zeros((len(hand), 15, 3))
    curls = hand[:, CURLS]
    for number, finger in enumerate(_FINGERS):
        curl = curls[:, _CURL_ORDER.index(finger)]
        joints = rotations[:, 3 * number : 3 * number + 3]
        joints[:, :, 2] = -sign * curl[:, None] * _FIST
        joints[:, 0, 1] = -sign * hand[:, SPREAD] * _SPREAD_ANGLE[number] * (1 - curl)
    thumb = curls[:, 0, None, None] * _THUMB_CURL
    thumb[:, 0, 1] -= _THUMB_ABDUCTION * hand[:, SPREAD]
    rotations[:, 12:15] = thumb * (1.0, sign, sign)
    return rotations
