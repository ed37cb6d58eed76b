"""Sweater and T-shirt: closed all round, with bands at the openings."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tools.avatars.cloth import TIGHTS, cut_along, from_edge, thick
from tools.avatars.necklines import Neckline
from tools.avatars.patch import Patch
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]

_BAND: Final = 0.035
"""Metres: how wide the bands of a sweater are at collar, cuffs and hem."""

_NARROW_BAND: Final = 0.016
_LONG: Final = 1.985
_SHORT: Final = 0.60
_TRIANGLES: Final = 2600
_SHORT_TRIANGLES: Final = 2000


def sweater(sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float) -> list[Piece]:
    """Return a sweater with long sleeves."""
    cloth = _cut(sitter, fabric, neckline, hem, _LONG)
    at = cloth.take(sitter.person.vertices)
    slack = 0.009 + 0.008 * np.clip(1 - (at[:, 1] - hem) / 0.25, 0, 1)
    cloth = cloth.raised(np.where(np.abs(at[:, 0]) > 0.2, 0.007, slack))
    return _banded(sitter, cloth, "sweater", _BAND, _TRIANGLES)


def t_shirt(sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float) -> list[Piece]:
    """Return a T-shirt whose sleeves end above the elbows."""
    cloth = _cut(sitter, fabric, neckline, hem, _SHORT)
    at = cloth.take(sitter.person.vertices)
    slack = 0.007 + 0.010 * np.clip(1 - (at[:, 1] - hem) / 0.25, 0, 1)
    along = np.maximum(sitter.along_arm(at, "left"), sitter.along_arm(at, "right"))
    wide = 0.006 + 0.014 * np.clip(along / _SHORT, 0, 1)
    cloth = cloth.raised(np.where(along > 0, np.maximum(wide, slack * (along < 0.1)), slack))
    return _banded(sitter, cloth, "sweater", _NARROW_BAND, _SHORT_TRIANGLES)


def _cut(sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float, sleeve: float) -> Patch:
    """Return `fabric` below the neckline, above the hem and up to the ends of the sleeves."""
    return cut_along(
        sitter,
        fabric,
        (
            lambda at: neckline.depth(sitter, at),
            lambda at: at[:, 1] - hem,
            lambda at: sleeve - sitter.along_arm(at, "left"),
            lambda at: sleeve - sitter.along_arm(at, "right"),
        ),
    )


def _banded(
    sitter: Sitter, cloth: Patch, material: str, band: float, triangles: int
) -> list[Piece]:
    """Return `cloth` as a garment with bands of another colour at its openings."""
    cloth, beyond = cloth.split(from_edge(sitter, cloth) - band)
    in_band = beyond[cloth.faces].sum(axis=1) < 0
    whole, added = thick(sitter, cloth, 0.007)
    trim = added.copy()
    trim[: len(in_band)] = in_band
    return sitter.pieces(whole, {material: ~trim, "trim": trim}, part=TIGHTS, triangles=triangles)
