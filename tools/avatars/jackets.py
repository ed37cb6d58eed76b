"""A jacket with lapels over a plain top."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from tools.avatars.buttons import buttons
from tools.avatars.cloth import TIGHTS, cut_along, thick
from tools.avatars.necklines import Neckline
from tools.avatars.patch import Patch, boundary_edges
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]

_OPENING: Final = Neckline(rise=0.004, slope=0.42, opening=0.30, width=0.075)
_CUFF: Final = 1.97
_LAPEL: Final = 0.042
_BELOW_HIPS: Final = 0.075
_TRIANGLES: Final = 2500
_TOP_TRIANGLES: Final = 420


def jacket(sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float) -> list[Piece]:
    """Return a buttoned jacket and the top that shows in its opening."""
    low = hem - _BELOW_HIPS
    neck = sitter.joint("neck")

    def front_edges(at: Array) -> Array:
        """Return how far beside the curved opening below the buttons `at` lies."""
        half = 0.55 * np.clip(hem + 0.03 - at[:, 1], 0, 1)
        return np.where(at[:, 2] > neck[2], np.abs(at[:, 0]) - half + 0.004, 1.0)

    cloth = cut_along(
        sitter,
        fabric,
        (
            lambda at: _OPENING.depth(sitter, at),
            lambda at: np.where(np.abs(at[:, 0]) < 0.3, at[:, 1] - low, 1.0),
            front_edges,
            lambda at: _CUFF - sitter.along_arm(at, "left"),
            lambda at: _CUFF - sitter.along_arm(at, "right"),
        ),
    )
    at = cloth.take(sitter.person.vertices)
    slack = 0.015 + 0.012 * np.clip(1 - (at[:, 1] - low) / 0.3, 0, 1)
    cloth = cloth.raised(np.where(np.abs(at[:, 0]) > 0.2, 0.012, slack))
    edges = at[boundary_edges(cloth.faces)].reshape(-1, 3)
    opening = edges[(edges[:, 1] > hem + 0.10) & (np.abs(edges[:, 0]) < 0.16)]
    distance, _ = cKDTree(opening).query(at)
    cloth, beyond = cloth.split(np.asarray(_LAPEL - distance))
    lapel = beyond[cloth.faces].sum(axis=1) > 0
    cloth = cloth.raised(np.where(beyond > -1e-6, 0.005, 0.0))
    whole, added = thick(sitter, cloth, 0.008)
    on_lapel = added.copy()
    on_lapel[:] = False
    on_lapel[: len(lapel)] = lapel
    button = float(neck[1]) - 0.35
    return [
        *sitter.pieces(
            whole, {"jacket": ~on_lapel, "lapels": on_lapel}, part=TIGHTS, triangles=_TRIANGLES
        ),
        buttons(sitter, cloth, [(0.006, button), (0.006, button - 0.09)], 0.009),
        _top(sitter, fabric, neckline),
    ]


def _top(sitter: Sitter, fabric: Patch, neckline: Neckline) -> Piece:
    """Return what shows of the top under the jacket."""
    neck = sitter.joint("neck")
    cloth = cut_along(
        sitter,
        fabric,
        (
            lambda at: neckline.depth(sitter, at),
            lambda at: 0.13 - np.abs(at[:, 0]),
            lambda at: np.where(
                at[:, 2] > neck[2],
                at[:, 1] - neck[1] + 0.42,
                0.06 - neckline.depth(sitter, at),
            ),
        ),
    )
    return sitter.piece("shirt", cloth.raised(0.007), part=TIGHTS, triangles=_TOP_TRIANGLES)
