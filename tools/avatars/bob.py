"""A bob: hair that falls from a parting over the ears to the chin, as one shell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.spatial import cKDTree

from motion.clip import ARKIT_NAMES
from motion.skeleton import JOINT_COUNT, joint_index
from tools.avatars.hair import head_centre
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter, mask

Array = NDArray[np.float64]

_COLUMNS: Final = 34
_UPPER_ROWS: Final = 10
_LOWER_ROWS: Final = 6
_FALLS_FROM: Final = 14.0
"""Degrees above the eyes at which hair leaves the skull and falls straight down."""

_REACH: Final = (
    # degrees above the eyes, degrees from the back to which the hair comes round
    (-60, 128), (-30, 124), (-5, 119), (10, 122), (25, 136), (36, 158), (44, 180), (90, 180),
)  # fmt: skip
_THICKNESS: Final = 0.015
_VOLUME: Final = 0.012
_SHELL: Final = 0.010
_TUCK: Final = 0.10
"""Share of its distance by which the hair curves inwards at the tips."""

_PARTING: Final = 12.0
"""Degrees of the parting to the body's left of the middle."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Skull:
    """Distance of the skull from its middle in each direction."""

    tree: cKDTree
    reach: Array

    @classmethod
    def of(cls, sitter: Sitter) -> _Skull:
        body = np.unique(sitter.person.parts["body"])
        at = sitter.person.vertices[body] - head_centre(sitter)
        head = (mask(sitter, "ears")[body] < 0.5) & (at[:, 1] > -0.05)
        reach = np.linalg.norm(at[head], axis=1)
        outer = reach > 0.06  # not the inside of the mouth
        return cls(tree=cKDTree((at[head] / reach[:, None])[outer]), reach=reach[outer])

    def towards(self, directions: Array) -> Array:
        """Return the skull's distance in unit `directions`, shape (n, 3), in metres."""
        distance, near = self.tree.query(directions, k=6)
        share = 1 / np.maximum(distance, 1e-4)
        return np.asarray((share * self.reach[near]).sum(axis=1) / share.sum(axis=1))


def bob(sitter: Sitter, length: float) -> Piece:
    """Return the hair, which falls `length` metres from eye level to the tips."""
    skull = _Skull.of(sitter)
    reach = PchipInterpolator(*np.array(_REACH, dtype=float).T)
    turn = np.linspace(-1, 1, _COLUMNS)
    rows, below = [], []
    for tilt in np.linspace(88, _FALLS_FROM, _UPPER_ROWS):
        azimuth = _azimuth(turn, tilt, reach)
        taper = 1 - 0.6 * np.abs(turn) ** 8 * np.clip((62 - tilt) / 18, 0, 1)
        rows.append(_on_skull(skull, tilt, azimuth, taper))
        below.append(_on_skull(skull, tilt, azimuth, 0 * taper) * 0.96)
    for share in np.linspace(0, 1, _LOWER_ROWS + 1)[1:]:
        rows.append(_falling(skull, share, length, turn, reach))
        flat = np.array([1.0, 0.0, 1.0])
        wide = np.linalg.norm(rows[-1] * flat, axis=1, keepdims=True)
        below.append(rows[-1] - rows[-1] * flat * _SHELL / wide)
    outer, inner = np.stack(rows), np.stack(below)
    vertices = np.concatenate([outer.reshape(-1, 3), inner.reshape(-1, 3)]) + head_centre(sitter)
    weights = np.zeros((len(vertices), JOINT_COUNT))
    weights[:, joint_index("head")] = 1.0
    faces = _faces(len(rows))
    used, flat = np.unique(faces, return_inverse=True)
    strands = 0.5 + 0.5 * np.sin(61 * np.tile(turn, 2 * len(rows))) * np.sin(
        23 * np.tile(turn, 2 * len(rows)) + 1.0
    )
    return Piece(
        material="hair",
        vertices=vertices[used],
        faces=flat.reshape(-1, 3),
        weights=weights[used],
        actions=np.zeros((len(ARKIT_NAMES), len(used), 3)),
        mixed={"hair_light": strands[used]},
    )


def _azimuth(turn: Array, tilt: float, reach: PchipInterpolator) -> Array:
    """Return degrees round the head from the back, towards the body's left."""
    high = np.clip((tilt - 20) / 30, 0, 1)
    return np.asarray(turn * float(reach(tilt)) + _PARTING * high)


def _on_skull(skull: _Skull, tilt: float, azimuth: Array, share: Array) -> Array:
    """Return points `share` of the way up to the hair's surface, `tilt` degrees above the eyes."""
    directions = _directions(tilt, azimuth)
    from_parting = np.abs(azimuth - _PARTING)
    groove = np.exp(-(((180 - from_parting) / 14) ** 2)) * np.clip((tilt - 30) / 30, 0, 1)
    waves = 0.0015 * np.sin(np.radians(azimuth) * 9 + 0.6)
    thick = _THICKNESS + _VOLUME * np.sin(np.radians(tilt)) - 0.010 * groove + waves
    return np.asarray(directions * (skull.towards(directions) + share * thick)[:, None])


def _falling(
    skull: _Skull, share: float, length: float, turn: Array, reach: PchipInterpolator
) -> Array:
    """Return points of the hair below, `share` of the way down to the tips."""
    taper = 1 - 0.6 * np.abs(turn) ** 8
    start = _on_skull(skull, _FALLS_FROM, turn * float(reach(_FALLS_FROM)), taper)
    height = start[:, 1] + share * (-length - start[:, 1])
    tilt = float(np.degrees(np.arctan2(height.mean(), 0.1)))
    azimuth = np.radians(turn * float(reach(np.clip(tilt, -60, _FALLS_FROM))))
    wide = np.hypot(start[:, 0], start[:, 2])
    wide = wide * (1 + 0.05 * np.sin(np.pi * share * 0.9) - _TUCK * share**3)
    wide = wide + 0.0015 * np.sin(azimuth * 9 + 0.6)
    return np.stack([wide * np.sin(azimuth), height, -wide * np.cos(azimuth)], axis=1)


def _directions(tilt: float, azimuth: Array) -> Array:
    """Return unit vectors `tilt` degrees above the horizon, turned `azimuth` from the back."""
    up, round_ = np.radians(tilt), np.radians(azimuth)
    return np.stack(
        [
            np.cos(up) * np.sin(round_),
            np.full(len(round_), np.sin(up)),
            -np.cos(up) * np.cos(round_),
        ],
        axis=1,
    )


def _faces(rows: int) -> NDArray[np.int64]:
    """Return the triangles: outside, inside where the hair falls, and the rim between."""
    row, column = np.divmod(np.arange((rows - 1) * (_COLUMNS - 1)), _COLUMNS - 1)
    a = row * _COLUMNS + column
    b, c, d = a + 1, a + _COLUMNS, a + _COLUMNS + 1
    outside = np.concatenate([np.stack([a, b, c], 1), np.stack([b, d, c], 1)])
    size = rows * _COLUMNS
    falls = np.tile(row >= _UPPER_ROWS - 4, 2)
    inside = outside[falls][:, ::-1] + size
    left = np.arange(rows) * _COLUMNS
    right = left + _COLUMNS - 1
    tips = (rows - 1) * _COLUMNS + np.arange(_COLUMNS)
    rims = [(left[:-1], left[1:]), (right[1:], right[:-1]), (tips[:-1], tips[1:])]
    rim = [
        np.concatenate([
            np.stack([start, end, end + size], 1), np.stack([start, end + size, start + size], 1)
        ])
        for start, end in rims
    ]  # fmt: skip
    return np.concatenate([outside, inside, *rim])
