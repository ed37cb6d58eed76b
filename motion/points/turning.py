"""Turns that take directions to others, for all frames at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

FloatArray = NDArray[np.float64]

_OPPOSITE = 1e-9
"""Below this, one plus the cosine between two directions means that they are opposite."""


def smallest_turns(present: FloatArray, wanted: FloatArray) -> Rotation:
    """Return the smallest turns that take directions `present` to `wanted`, each (T, 3)."""
    present, wanted = _units(present), _units(wanted)
    scalar = 1 + (present * wanted).sum(axis=1)
    vector = np.cross(present, wanted)
    opposite = scalar < _OPPOSITE
    if opposite.any():
        least = np.eye(3)[np.abs(present[opposite]).argmin(axis=1)]
        vector[opposite] = _units(np.cross(present[opposite], least))
    return Rotation.from_quat(np.column_stack([vector, scalar]))


def turns_of_frames(
    present: tuple[FloatArray, FloatArray], wanted: tuple[FloatArray, FloatArray]
) -> Rotation:
    """Return the turns that take a first direction exactly and a second as near as they can.

    Parameters
    ----------
    present : pair of ndarray, shape (3,)
        Two directions at rest.
    wanted : pair of ndarray, shape (T, 3)
        Where they point in each frame. Where both are one line, any turn about it may come out.
    """
    rest = _frames(present[0][None], present[1][None])
    return Rotation.from_matrix(_frames(*wanted) @ np.swapaxes(rest, 1, 2))


def _frames(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return right-handed frames whose first axes, columns, are `first`, shape (T, 3, 3)."""
    first = _units(first)
    across = np.cross(first, second)
    line = np.linalg.norm(across, axis=1) < _OPPOSITE
    if line.any():
        across[line] = np.cross(first[line], np.eye(3)[np.abs(first[line]).argmin(axis=1)])
    third = _units(across)
    return np.stack([first, np.cross(third, first), third], axis=2)


def _units(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
