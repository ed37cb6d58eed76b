"""Pieces of an avatar's surface, in Anny's stance."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

MATERIALS: Final = (
    "skin", "lips", "mouth", "teeth", "tongue", "sclera", "iris", "limbus", "pupil", "brow",
    "lash", "hair", "beard", "nails", "sweater", "trim", "shirt", "collar", "jacket", "lapels",
    "buttons", "trousers", "shoes", "soles", "glasses", "bone", "left bone", "right bone",
)  # fmt: skip
"""Materials of vertices; an avatar's palette has a colour for each that it uses."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """One piece of one material.

    Attributes
    ----------
    material : str
        One of `MATERIALS`.
    vertices : ndarray, shape (n, 3)
        Positions in metres, in Anny's stance.
    faces : ndarray, shape (F, 3)
        Triangles.
    weights : ndarray, shape (n, 55)
        Skin weights.
    actions : ndarray, shape (52, n, 3)
        Offsets of each facial action in the order of `motion.clip.ARKIT_NAMES`.
    mixed : mapping of str to ndarray, shape (n,)
        Shares of further colours of the palette, in [0, 1].
    """

    material: str
    vertices: Array
    faces: Indices
    weights: Array
    actions: Array
    mixed: Mapping[str, Array] = field(default_factory=dict)
