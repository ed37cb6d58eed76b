"""Buttons, sewn onto cloth."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from motion.clip import ARKIT_NAMES
from tools.avatars.cloth import TIGHTS
from tools.avatars.patch import Patch
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

_SIDES: Final = 8
_RADIUS: Final = 0.0055
_ABOVE: Final = 0.003


def buttons(
    sitter: Sitter, cloth: Patch, places: Sequence[tuple[float, float]], radius: float = _RADIUS
) -> Piece:
    """Return flat buttons on the front of `cloth`.

    Parameters
    ----------
    sitter : Sitter
        The person.
    cloth : Patch
        The cloth under them.
    places : sequence of (float, float)
        Metres to the body's left of the middle, and height in stance.
    radius : float
        Radius in metres.
    """
    surface = sitter.raised(cloth, TIGHTS)
    normals = cloth.take(sitter.outwards(TIGHTS))
    front = np.flatnonzero(normals[:, 2] > 0.3)
    tree = cKDTree(surface[front, :2])
    weights = cloth.take(sitter.weights)[front]
    turn = 2 * np.pi * np.arange(_SIDES) / _SIDES
    vertices, sewn = [], []
    for aside, height in places:
        distance, near = tree.query([aside, height], k=6)
        share = 1 / np.maximum(distance, 1e-5)
        share /= share.sum()
        depth = float(share @ surface[front][near, 2])
        facing = share @ normals[front][near]
        slope = facing[:2] / facing[2]
        disc = np.stack([aside + radius * np.cos(turn), height + radius * np.sin(turn)], axis=1)
        lean = -(disc - [aside, height]) @ slope
        vertices.append(np.column_stack([disc, depth + _ABOVE + lean]))
        sewn.append(np.tile(share @ weights[near], (_SIDES, 1)))
    fan = np.stack([[0, k, k + 1] for k in range(1, _SIDES - 1)])
    faces = np.concatenate([fan + _SIDES * number for number in range(len(places))])
    at = np.concatenate(vertices)
    return Piece(
        material="buttons",
        vertices=at,
        faces=faces,
        weights=np.concatenate(sewn),
        actions=np.zeros((len(ARKIT_NAMES), len(at), 3)),
    )
