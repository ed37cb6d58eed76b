"""The pose of one arm and hand, in parameters that are the same for left and right."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True)
class HandShape:
    """How far each finger is curled: 0 straight, 1 in a fist; and how far they are spread."""

    thumb: float
    index: float
    middle: float
    ring: float
    pinky: float
    spread: float


@dataclass(frozen=True, kw_only=True)
class HandPose:
    """Position and orientation of a hand.

    Attributes
    ----------
    outward, up, forward : float
        From the shoulder to the wrist in the chest's own frame, in arm lengths (shoulder to
        wrist); outward is away from the other arm.
    elbow_out : float
        Degrees by which the elbow is raised to the side from where it hangs by itself.
    pronation : float
        Degrees of turning the forearm: 0 with the thumb up, +80 palm down, -80 palm up.
    flexion : float
        Degrees of bending the wrist towards the palm.
    deviation : float
        Degrees of bending the wrist towards the thumb.
    shape : HandShape
    """

    outward: float
    up: float
    forward: float
    elbow_out: float
    pronation: float
    flexion: float
    deviation: float
    shape: HandShape

    def channels(self) -> NDArray[np.float64]:
        """Return the pose as one vector, shape (13,); its parts are the slices below."""
        *arm, shape = astuple(self)
        return np.array([*arm, *shape], float)


PLACE: Final = slice(0, 3)
ELBOW_OUT: Final = 3
PRONATION: Final = 4
FLEXION: Final = 5
DEVIATION: Final = 6
CURLS: Final = slice(7, 12)
SPREAD: Final = 12
CHANNELS: Final = 13

MOST_PRONATION: Final = 80.0
MOST_FLEXION: Final = 70.0
MOST_DEVIATION: Final = 20.0


def clip_to_joint_range(course: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return hand channels, shape (T, 13), kept within what wrists and fingers can do."""
    limited = course.copy()
    for channel, limit in (
        (PRONATION, MOST_PRONATION),
        (FLEXION, MOST_FLEXION),
        (DEVIATION, MOST_DEVIATION),
    ):
        limited[:, channel] = np.clip(limited[:, channel], -limit, limit)
    limited[:, CURLS] = np.clip(limited[:, CURLS], 0, 1)
    limited[:, SPREAD] = np.clip(limited[:, SPREAD], -0.6, 1)
    return limited


RELAXED: Final = HandShape(thumb=0.25, index=0.24, middle=0.32, ring=0.38, pinky=0.42, spread=0.1)
SOFT: Final = HandShape(thumb=0.28, index=0.2, middle=0.26, ring=0.31, pinky=0.34, spread=-0.4)
LYING: Final = HandShape(thumb=0.2, index=0.2, middle=0.24, ring=0.28, pinky=0.3, spread=-0.6)
OPEN: Final = HandShape(thumb=0.05, index=0.08, middle=0.1, ring=0.13, pinky=0.14, spread=0.4)
FLAT: Final = HandShape(thumb=0.2, index=0.05, middle=0.06, ring=0.08, pinky=0.1, spread=0.0)
WIDE: Final = HandShape(thumb=0.0, index=0.03, middle=0.04, ring=0.06, pinky=0.05, spread=0.9)
FIST: Final = HandShape(thumb=0.8, index=0.9, middle=0.93, ring=0.95, pinky=0.95, spread=0.0)
LOOSE_FIST: Final = HandShape(thumb=0.5, index=0.55, middle=0.62, ring=0.68, pinky=0.7, spread=0.0)
PINCH: Final = HandShape(thumb=0.6, index=0.58, middle=0.36, ring=0.3, pinky=0.28, spread=0.15)
POINTING: Final = HandShape(thumb=0.6, index=0.04, middle=0.75, ring=0.82, pinky=0.85, spread=0.0)

BY_THE_SIDE: Final = HandPose(
    outward=0.10, up=-0.94, forward=0.14, elbow_out=0, pronation=25, flexion=6, deviation=0,
    shape=RELAXED,
)  # fmt: skip
HELD_OFF: Final = HandPose(
    outward=0.16, up=-0.90, forward=0.26, elbow_out=0, pronation=25, flexion=6, deviation=0,
    shape=SOFT,
)  # fmt: skip
HANGING_SLACK: Final = HandPose(
    outward=0.16, up=-0.85, forward=0.42, elbow_out=0, pronation=35, flexion=10, deviation=0,
    shape=SOFT,
)  # fmt: skip
BEFORE_THE_WAIST: Final = HandPose(
    outward=-0.04, up=-0.60, forward=0.50, elbow_out=0, pronation=30, flexion=-4, deviation=0,
    shape=SOFT,
)  # fmt: skip
BEFORE_THE_CHEST: Final = HandPose(
    outward=0.0, up=-0.5, forward=0.46, elbow_out=-8, pronation=20, flexion=0, deviation=4,
    shape=LOOSE_FIST,
)  # fmt: skip
FISTS_BY_THE_SIDE: Final = HandPose(
    outward=0.20, up=-0.88, forward=0.20, elbow_out=14, pronation=40, flexion=4, deviation=0,
    shape=FIST,
)  # fmt: skip
CLASPED_UNDER: Final = HandPose(
    outward=-0.184, up=-0.724, forward=0.50, elbow_out=0, pronation=6.5, flexion=27, deviation=-1,
    shape=LYING,
)  # fmt: skip
CLASPED_OVER: Final = HandPose(
    outward=-0.216, up=-0.703, forward=0.646, elbow_out=-2, pronation=19, flexion=26, deviation=0,
    shape=LYING,
)  # fmt: skip


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
