"""Trousers and shoes."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tools.avatars.cloth import TIGHTS, cut_along
from tools.avatars.patch import Patch, boundary_edges, hemmed
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]

_TRIANGLES: Final = 1000
_SHOE_TRIANGLES: Final = 700
_UNDER_TOP: Final = 0.05
_FLARE: Final = 0.012


def trousers(sitter: Sitter, fabric: Patch, hem: float) -> Piece:
    """Return trousers that reach up under a top whose hem is at height `hem`, in metres."""
    top, bottom = hem + _UNDER_TOP, sitter.joint("left_ankle")[1] + 0.01
    cloth = cut_along(
        sitter,
        fabric,
        (
            lambda at: np.where(np.abs(at[:, 0]) < 0.3, top - at[:, 1], -1.0),
            lambda at: at[:, 1] - bottom,
        ),
    )
    at = cloth.take(sitter.person.vertices)
    cloth = cloth.raised(0.005 + _FLARE * np.clip(1 - (at[:, 1] - bottom) / 0.35, 0, 1))
    edges = boundary_edges(cloth.faces)
    low = at[edges, 1].max(axis=1) < bottom + 0.01
    rimmed = hemmed(cloth, edges[low], 0.006)
    return sitter.piece("trousers", rimmed, part=TIGHTS, triangles=_TRIANGLES)


def shoes(sitter: Sitter, fabric: Patch) -> list[Piece]:
    """Return both shoes with their soles."""
    top = sitter.joint("left_ankle")[1] + 0.06
    at = fabric.take(sitter.person.vertices)
    floor = at[:, 1].min()
    leather = fabric.cut(top - at[:, 1]).raised(0.006)
    leather, above = leather.split(leather.take(sitter.person.vertices)[:, 1] - floor - 0.018)
    sole = above[leather.faces].sum(axis=1) < 0
    leather = leather.raised(np.where(above <= 0, 0.003, 0.0))
    return sitter.pieces(
        leather, {"shoes": ~sole, "soles": sole}, part=TIGHTS, triangles=_SHOE_TRIANGLES
    )
