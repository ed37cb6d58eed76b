"""The pose of one arm and hand, in parameters that are the same for left and right."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Annotated, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, TypeAdapter


@dataclass(frozen=True, kw_only=True)
class HandShape:
    """How far each finger is curled: 0 straight, 1 in a fist; and how far they are spread."""

    thumb: float
    index: float
    middle: float
    ring: float
    pinky: float
    spread: float


_HANDS: Final = tomllib.loads(Path(__file__).with_name("hands.toml").read_text("utf-8"))

SHAPES: Final = {name: HandShape(**values) for name, values in _HANDS["shapes"].items()}

RELATED_SHAPES: Final[Mapping[HandShape, Sequence[HandShape]]] = {
    SHAPES[name]: [SHAPES[other] for other in others] for name, others in _HANDS["related"].items()
}
"""Shapes that a hand may come near to instead."""

NamedShape = Annotated[HandShape, BeforeValidator(lambda name: SHAPES[name])]
"""A shape, which a table names."""


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
    elbow_out: float = 0
    pronation: float
    flexion: float
    deviation: float = 0
    shape: NamedShape

    def channels(self) -> NDArray[np.float64]:
        """Return the pose as one vector, shape (13,); its parts are the slices below."""
        *arm, shape = astuple(self)
        return np.array([*arm, *shape], float)


POSES: Final = TypeAdapter(dict[str, HandPose]).validate_python(_HANDS["poses"])

NamedPose = Annotated[HandPose, BeforeValidator(lambda name: POSES[name])]
"""A pose, which a table names."""

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
