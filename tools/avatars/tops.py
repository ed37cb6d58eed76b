"""Garments worn above the trousers, by name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from tools.avatars.buttons import buttons
from tools.avatars.cloth import TIGHTS, cut_along, from_edge, thick
from tools.avatars.necklines import Neckline
from tools.avatars.patch import Patch, boundary_edges, hemmed
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]

_BAND: Final = 0.035
"""Width of a sweater's bands at collar, cuffs and hem, in metres."""

_NARROW_BAND: Final = 0.016
_LONG: Final = 1.985
"""End of long sleeves: 1 at the elbow, 2 at the wrist."""

_SHORT: Final = 0.60
_CUFF_WIDTH: Final = 0.22
"""Length of the cuff as a share of the forearm."""

_V_NECK: Final = Neckline(rise=-0.006, opening=0.12, width=0.065)
_STAND: Final = 0.026
"""Metres by which the collar rises above the neckline before it folds."""

_LEAF: Final = 0.028
_POINT: Final = 0.026
_BUTTONS: Final = (0.075, 0.155, 0.235, 0.315, 0.395)
"""Metres below the joint of the neck."""

_OPENING: Final = Neckline(rise=0.004, slope=0.42, opening=0.30, width=0.075)
_JACKET_SLEEVE: Final = 1.97
_LAPEL: Final = 0.042
_BELOW_HIPS: Final = 0.075


def sweater(sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float) -> list[Piece]:
    """Return a sweater with long sleeves."""
    cloth = _cut(sitter, fabric, neckline, hem, _LONG)
    at = cloth.take(sitter.person.vertices)
    slack = 0.009 + 0.008 * np.clip(1 - (at[:, 1] - hem) / 0.25, 0, 1)
    cloth = cloth.raised(np.where(np.abs(at[:, 0]) > 0.2, 0.007, slack))
    return _banded(sitter, cloth, _BAND, 2600)


def t_shirt(sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float) -> list[Piece]:
    """Return a T-shirt whose sleeves end above the elbows."""
    cloth = _cut(sitter, fabric, neckline, hem, _SHORT)
    at = cloth.take(sitter.person.vertices)
    slack = 0.007 + 0.010 * np.clip(1 - (at[:, 1] - hem) / 0.25, 0, 1)
    along = np.maximum(sitter.along_arm(at, "left"), sitter.along_arm(at, "right"))
    wide = 0.006 + 0.014 * np.clip(along / _SHORT, 0, 1)
    cloth = cloth.raised(np.where(along > 0, np.maximum(wide, slack * (along < 0.1)), slack))
    return _banded(sitter, cloth, _NARROW_BAND, 2000)


def shirt(sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float) -> list[Piece]:
    """Return a shirt with long sleeves, its top button open."""
    cloth = _cut(sitter, fabric, neckline, hem - 0.02, _LONG)
    at = cloth.take(sitter.person.vertices)
    along = np.maximum(sitter.along_arm(at, "left"), sitter.along_arm(at, "right"))
    cloth, beyond = cloth.split(along - (_LONG - _CUFF_WIDTH))
    at = cloth.take(sitter.person.vertices)
    slack = 0.008 + 0.009 * np.clip(1 - (at[:, 1] - hem) / 0.25, 0, 1)
    cloth = cloth.raised(np.where(np.abs(at[:, 0]) > 0.2, 0.008, slack))
    cloth = cloth.raised(np.where(beyond > -1e-6, 0.002, 0.0))
    in_cuff = beyond[cloth.faces].sum(axis=1) > 0
    heights = [float(sitter.joint("neck")[1]) - down for down in _BUTTONS]
    return [
        *_trimmed(sitter, cloth, in_cuff, ("shirt", "trim"), 0.007, 2300),
        *collar(sitter, fabric, neckline, 0.011),
        buttons(sitter, cloth, [(0.0, height) for height in heights]),
    ]


def sweater_over_shirt(
    sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float
) -> list[Piece]:
    """Return a sweater with a V-neck, and the shirt that shows in it with its collar outside."""
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
        sitter.piece("shirt", front.raised(0.005), part=TIGHTS, triangles=160),
        buttons(sitter, front.raised(0.004), [(0.0, float(neck[1]) - 0.085)]),
        *collar(sitter, fabric, neckline, 0.0165),
    ]


def collar(sitter: Sitter, fabric: Patch, neckline: Neckline, lift: float) -> list[Piece]:
    """Return a collar that rises from the neckline and folds over it, `lift` metres off."""
    line = Neckline(rise=neckline.rise, slope=neckline.slope)
    neck = sitter.joint("neck")

    def gap(at: Array) -> Array:
        """Return the distance of `at` from the opening in front."""
        below = line.depth(sitter, at)
        half = 0.004 + 0.42 * np.clip(below + _STAND, 0, 1)
        return np.where(at[:, 2] > neck[2], np.abs(at[:, 0]) - half, 1.0)

    around = fabric.cut(line.depth(sitter, fabric.take(sitter.person.vertices)))
    edge = around.take(sitter.person.vertices)[boundary_edges(around.faces)].reshape(-1, 3)
    tree = cKDTree(edge[np.linalg.norm(edge - neck, axis=1) < 0.2])

    def leaf_end(at: Array) -> Array:
        """Return the distance of `at` from the end of the leaf, which has points in front."""
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
        sitter.piece("collar", whole, part=TIGHTS, triangles=420),
        _inside_out(sitter, inner),
    ]


def _inside_out(sitter: Sitter, stand: Patch) -> Piece:
    """Return the inside of the collar's stand, which is visible across the neck."""
    turned = Patch(blend=stand.blend, faces=stand.faces[:, ::-1], lift=stand.lift)
    return sitter.piece("collar", turned, part=TIGHTS, triangles=120)


def jacket(sitter: Sitter, fabric: Patch, neckline: Neckline, hem: float) -> list[Piece]:
    """Return a buttoned jacket and the top that shows in its opening."""
    low = hem - _BELOW_HIPS
    neck = sitter.joint("neck")

    def front_edges(at: Array) -> Array:
        """Return the distance of `at` from the curved opening below the buttons."""
        half = 0.55 * np.clip(hem + 0.03 - at[:, 1], 0, 1)
        return np.where(at[:, 2] > neck[2], np.abs(at[:, 0]) - half + 0.004, 1.0)

    cloth = cut_along(
        sitter,
        fabric,
        (
            lambda at: _OPENING.depth(sitter, at),
            lambda at: np.where(np.abs(at[:, 0]) < 0.3, at[:, 1] - low, 1.0),
            front_edges,
            lambda at: _JACKET_SLEEVE - sitter.along_arm(at, "left"),
            lambda at: _JACKET_SLEEVE - sitter.along_arm(at, "right"),
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
    button = float(neck[1]) - 0.35
    return [
        *_trimmed(sitter, cloth, lapel, ("jacket", "lapels"), 0.008, 2500, rim=False),
        buttons(sitter, cloth, [(0.006, button), (0.006, button - 0.09)], 0.009),
        _plain_top(sitter, fabric, neckline),
    ]


def _plain_top(sitter: Sitter, fabric: Patch, neckline: Neckline) -> Piece:
    """Return the visible part of the top under the jacket."""
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
    return sitter.piece("shirt", cloth.raised(0.007), part=TIGHTS, triangles=420)


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


def _banded(sitter: Sitter, cloth: Patch, band: float, triangles: int) -> list[Piece]:
    """Return `cloth` as a garment with bands of another colour at its openings."""
    cloth, beyond = cloth.split(from_edge(sitter, cloth) - band)
    in_band = beyond[cloth.faces].sum(axis=1) < 0
    return _trimmed(sitter, cloth, in_band, ("sweater", "trim"), 0.007, triangles)


def _trimmed(
    sitter: Sitter,
    cloth: Patch,
    trim: NDArray[np.bool_],
    materials: tuple[str, str],
    thickness: float,
    triangles: int,
    *,
    rim: bool = True,
) -> list[Piece]:
    """Return `cloth`, `thickness` metres thick, with the triangles `trim` in the second material.

    Its rim is in that material too if `rim`.
    """
    whole, added = thick(sitter, cloth, thickness)
    trimmed = added & rim
    trimmed[: len(trim)] = trim
    main, other = materials
    parts = {main: ~trimmed, other: trimmed}
    return sitter.pieces(whole, parts, part=TIGHTS, triangles=triangles)


@dataclass(frozen=True, kw_only=True)
class Top:
    """A garment, or several worn together.

    Attributes
    ----------
    neckline : Neckline
        The line above which the skin is bare.
    sleeve : float
        End of the sleeves: 0 at the shoulder, 1 at the elbow, 2 at the wrist.
    make : callable
        Makes its pieces from the person, the fabric, the neckline and the height of its hem.
    """

    neckline: Neckline
    sleeve: float
    make: Callable[[Sitter, Patch, Neckline, float], list[Piece]]


TOPS: Final[Mapping[str, Top]] = MappingProxyType({
    "sweater": Top(neckline=Neckline(), sleeve=1.98, make=sweater),
    "shirt": Top(
        neckline=Neckline(rise=-0.006, opening=0.07, width=0.03), sleeve=1.98, make=shirt
    ),
    "sweater_over_shirt": Top(
        neckline=Neckline(rise=-0.006, opening=0.055, width=0.02),
        sleeve=1.98,
        make=sweater_over_shirt,
    ),
    "jacket": Top(neckline=Neckline(rise=-0.03), sleeve=1.97, make=jacket),
    "t_shirt": Top(neckline=Neckline(rise=-0.01), sleeve=0.6, make=t_shirt),
})  # fmt: skip
