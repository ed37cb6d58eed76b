"""Shirts: a collar, buttons and cuffs; also the collar of a shirt worn under a sweater."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from tools.avatars.buttons import buttons
from tools.avatars.cloth import TIGHTS, cut_along, thick
from tools.avatars.knitwear import sweater
from tools.avatars.necklines import Neckline
from tools.avatars.patch import Patch, boundary_edges, hemmed
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]

_CUFF: Final = 1.985
_CUFF_WIDTH: Final = 0.22
"""Share of the forearm that the cuff takes."""

_TRIANGLES: Final = 2300
_COLLAR_TRIANGLES: Final = 420
_FRONT_TRIANGLES: Final = 160
_V_NECK: Final = Neckline(rise=-0.006, opening=0.12, width=0.065)
_STAND: Final = 0.026
"""Metres that the collar stands up above the neckline before it folds."""

_LEAF: Final = 0.028
_POINT: Final = 0.026
_BUTTONS: Final = (0.075, 0.155, 0.235, 0.315, 0.395)
"""Metres below the joint of the neck."""


def shirt(sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float) -> list[Piece]:
    """Return a shirt with long sleeves, its top button open."""
    cloth = cut_along(
        sitter,
        fabric,
        (
            lambda at: neckline.depth(sitter, at),
            lambda at: at[:, 1] - hem + 0.02,
            lambda at: _CUFF - sitter.along_arm(at, "left"),
            lambda at: _CUFF - sitter.along_arm(at, "right"),
        ),
    )
    at = cloth.take(sitter.person.vertices)
    along = np.maximum(sitter.along_arm(at, "left"), sitter.along_arm(at, "right"))
    cloth, beyond = cloth.split(along - (_CUFF - _CUFF_WIDTH))
    at = cloth.take(sitter.person.vertices)
    slack = 0.008 + 0.009 * np.clip(1 - (at[:, 1] - hem) / 0.25, 0, 1)
    cloth = cloth.raised(np.where(np.abs(at[:, 0]) > 0.2, 0.008, slack))
    cloth = cloth.raised(np.where(beyond > -1e-6, 0.002, 0.0))
    in_cuff = beyond[cloth.faces].sum(axis=1) > 0
    whole, added = thick(sitter, cloth, 0.007)
    trim = added.copy()
    trim[: len(in_cuff)] = in_cuff
    body = sitter.pieces(whole, {"shirt": ~trim, "trim": trim}, part=TIGHTS, triangles=_TRIANGLES)
    heights = [float(sitter.joint("neck")[1]) - down for down in _BUTTONS]
    return [
        *body,
        *collar(sitter, fabric, neckline, 0.011),
        buttons(sitter, cloth, [(0.0, height) for height in heights]),
    ]


def sweater_over_shirt(
    sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float
) -> list[Piece]:
    """Return a sweater with a V-neck, and the shirt that shows in it and folds over it."""
    neck = sitter.joint("neck")
    front = cut_along(
        sitter,
        fabric,
        (
            lambda at: neckline.depth(sitter, at),
            lambda at: np.where(at[:, 2] > neck[2], 0.10 - np.abs(at[:, 0]), -1.0),
            lambda at: at[:, 1] - neck[1] + 0.22,
        ),
    )
    return [
        *sweater(sitter, fabric, _V_NECK, hem),
        sitter.piece("shirt", front.raised(0.005), part=TIGHTS, triangles=_FRONT_TRIANGLES),
        buttons(sitter, front.raised(0.004), [(0.0, float(neck[1]) - 0.085)]),
        *collar(sitter, fabric, neckline, 0.0165),
    ]


def collar(sitter: Sitter, fabric: Patch, neckline: Neckline, lift: float) -> list[Piece]:
    """Return a collar that stands up from the neckline and folds over it, `lift` metres off."""
    line = Neckline(rise=neckline.rise, slope=neckline.slope)
    neck = sitter.joint("neck")

    def gap(at: Array) -> Array:
        """Return how far beside the opening in front `at` lies."""
        below = line.depth(sitter, at)
        half = 0.004 + 0.42 * np.clip(below + _STAND, 0, 1)
        return np.where(at[:, 2] > neck[2], np.abs(at[:, 0]) - half, 1.0)

    around = fabric.cut(line.depth(sitter, fabric.take(sitter.person.vertices)))
    edge = around.take(sitter.person.vertices)[boundary_edges(around.faces)].reshape(-1, 3)
    tree = cKDTree(edge[np.linalg.norm(edge - neck, axis=1) < 0.2])

    def leaf_end(at: Array) -> Array:
        """Return how far before the end of the leaf `at` lies; it has points in front."""
        distance, _ = tree.query(at)
        point = np.exp(-(((np.abs(at[:, 0]) - 0.036) / 0.020) ** 2)) * (at[:, 2] > neck[2])
        distance = np.where(line.depth(sitter, at) > 0, distance, -distance)
        return np.asarray(_LEAF + _POINT * point - distance)

    stand = cut_along(
        sitter,
        fabric,
        (
            lambda at: line.depth(sitter, at) + _STAND,
            lambda at: 0.02 - line.depth(sitter, at),
            lambda at: gap(at) + 0.002,
        ),
    )
    leaf = cut_along(
        sitter,
        fabric,
        (lambda at: line.depth(sitter, at) + _STAND, leaf_end, gap),
    )
    fold = np.clip((line.depth(sitter, leaf.take(sitter.person.vertices)) + _STAND) / 0.02, 0, 1)
    leaf = leaf.raised(0.004 + (lift - 0.004) * np.sqrt(fold))
    whole = hemmed(leaf, boundary_edges(leaf.faces), 0.004)
    inner = stand.raised(0.003)
    return [
        sitter.piece("collar", whole, part=TIGHTS, triangles=_COLLAR_TRIANGLES),
        _inside_out(sitter, inner),
    ]


def _inside_out(sitter: Sitter, stand: Patch) -> Piece:
    """Return the inside of the collar's stand, which one sees across the neck."""
    turned = Patch(blend=stand.blend, faces=stand.faces[:, ::-1], lift=stand.lift)
    return sitter.piece("collar", turned, part=TIGHTS, triangles=120)
