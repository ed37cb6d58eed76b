"""Motion of TED Gesture (Yoon et al. 2020) as plain arrays: ten joints of the upper body.

One ``.npz`` file per clip, with one of the arrays

``joints``
    (T, 10, 3), positions in any unit.
``directions``
    (T, 9, 3) or (T, 27), unit vectors along the bones of `BONES`; nothing subtracted.

and ``frame_rate`` if it is not 15.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion.arrays import Floats, Floats32
from motion.clip import check_frame_rate
from motion.errors import InputError, found_at
from motion.formats.archives import load_arrays

FRAME_RATE: Final = 15.0
JOINTS: Final = 10
JOINT_NAMES: Final = (
    "pelvis",
    "neck",
    "jaw",
    "head",
    "left_shoulder",
    "left_elbow",
    "left_wrist",
    "right_shoulder",
    "right_elbow",
    "right_wrist",
)
"""The ten joints by our body's names; the jaw stands for the nose."""

BONES: Final = ((0, 1), (1, 2), (2, 3), (1, 4), (4, 5), (5, 6), (1, 7), (7, 8), (8, 9))
"""Parent and child: spine to neck, nose, top of the head; then shoulder, elbow and wrist of the
left and of the right."""

AXES: Final = np.array([-1.0, -1.0, 1.0])
"""Signs of TED Gesture's axes in ours: its x points to the person's right, y down, z forward."""

ARRAYS: Final = ("directions", "joints")
_UNIT: Final = 0.05
"""Largest difference of a direction's length from 1."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TedMotion:
    """Motion of the upper body as directions of bones.

    Attributes
    ----------
    directions : ndarray, shape (T, 9, 3), float32
        Unit vectors from parent to child, in the order of `BONES`.
    frame_rate : float
        Frames per second.
    """

    directions: Floats32
    frame_rate: float


def chain_bones(bones: NDArray[Any]) -> Floats:
    """Return the ten joints (T, 10, 3) at the ends of `BONES` vectors (T, 9, 3), the first at 0."""
    joints = np.zeros((len(bones), JOINTS, 3))
    for bone, (parent, child) in enumerate(BONES):
        joints[:, child] = joints[:, parent] + bones[:, bone]
    return joints


def read_ted_npz(path: Path) -> TedMotion:
    """Read the motion of a clip.

    Raises
    ------
    InputError
        If the file is damaged, has neither array or no frames, or holds a value that is not finite,
        a bone without length or directions that are not unit vectors. Pickled content is never
        loaded.
    """
    with found_at(path):
        return _motion(load_arrays(path, (*ARRAYS, "frame_rate")))


def _motion(arrays: Mapping[str, NDArray[Any]]) -> TedMotion:
    frame_rate = float(arrays["frame_rate"]) if "frame_rate" in arrays else FRAME_RATE
    check_frame_rate(frame_rate)
    if "directions" in arrays:
        directions = _numbers(arrays["directions"], (9, 3))
        lengths = np.linalg.norm(directions, axis=2, keepdims=True)
        if np.abs(lengths - 1).max() > _UNIT:
            raise InputError(
                f"a direction has length {lengths.flat[np.abs(lengths - 1).argmax()]:.3g}",
                remedy="Give unit vectors, from which no mean was subtracted",
            )
    elif "joints" in arrays:
        joints = _numbers(arrays["joints"], (JOINTS, 3))
        parents, children = np.array(BONES).T
        directions = joints[:, children] - joints[:, parents]
        lengths = np.linalg.norm(directions, axis=2, keepdims=True)
        if not lengths.all():
            frame, bone = map(int, np.argwhere(lengths[:, :, 0] == 0)[0])
            raise InputError(
                f"bone {bone} has no length in frame {frame}",
                remedy="Cut out frames in which joints were not found",
            )
    else:
        raise InputError(
            "the file holds no motion of TED Gesture", remedy=f"Give one of {', '.join(ARRAYS)}"
        )
    return TedMotion(directions=(directions / lengths).astype(np.float32), frame_rate=frame_rate)


def _numbers(array: NDArray[Any], shape: tuple[int, int]) -> Floats:
    """Return `array` as (T, *shape) finite numbers."""
    width = shape[0] * shape[1]
    fits = array.ndim in (2, 3) and len(array) and array[0].size == width
    if not fits or array.dtype.kind not in "fiu":
        raise InputError(
            f"the array has shape {array.shape} and type {array.dtype}",
            remedy=f"Give numbers of shape (frames, {width}) or (frames, {shape[0]}, {shape[1]})",
        )
    numbers = array.astype(np.float64).reshape(len(array), *shape)
    if not np.isfinite(numbers).all():
        raise InputError(
            f"frame {int(np.argwhere(~np.isfinite(numbers))[0, 0])} holds no number",
            remedy="Repair or cut it",
        )
    return numbers
