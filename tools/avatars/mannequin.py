"""Neutral figures in a close-fitting suit of one colour, without and with a face."""

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.ndimage import gaussian_filter
from scipy.spatial import cKDTree

from motion.clip import ARKIT_NAMES
from motion.skeleton import joint_index
from tools.avatars.cloth import TIGHTS, cut_along, smoothed, thick
from tools.avatars.eyes import eyeballs
from tools.avatars.hair import head_centre
from tools.avatars.hands import arms
from tools.avatars.head import head
from tools.avatars.necklines import Neckline
from tools.avatars.patch import Patch
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter, mask
from tools.avatars.trousers import shoes

Array = NDArray[np.float64]

_COLUMNS: Final = 40
_UPPER_ROWS: Final = 16
_LOWER_ROWS: Final = 18
_BELOW_NECK: Final = 0.055
_SMOOTHED_BY: Final = (1.6, 1.8)
"""Rows and columns over which features of the head are smoothed away."""

_SMOOTHING_ROUNDS: Final = 14
_SHRUNK_BY: Final = 0.010
"""Metres by which smoothing shrinks the trunk, and by which it is raised again."""

_SUIT_TRIANGLES: Final = 3600
_NECKLINE: Final = Neckline(rise=0.002)
_WRIST: Final = 1.985


def mannequin(sitter: Sitter, fabric: Patch) -> list[Piece]:
    """Return all pieces of the mannequin."""
    pieces = [
        _head(sitter),
        *arms(sitter, _WRIST),
        _suit(sitter, fabric),
        *shoes(sitter, fabric),
    ]
    return [replace(piece, weights=_without_jaw(piece.weights)) for piece in pieces]


def grey_person(sitter: Sitter, fabric: Patch) -> list[Piece]:
    """Return all pieces of a person in the same suit, with a face and without hair."""
    return [
        *head(sitter, _NECKLINE),
        *eyeballs(sitter),
        *arms(sitter, _WRIST),
        _suit(sitter, fabric),
        *shoes(sitter, fabric),
    ]


def _suit(sitter: Sitter, fabric: Patch) -> Piece:
    """Return the suit, from neck to wrists and ankles."""
    ankle = sitter.joint("left_ankle")[1]
    cloth = cut_along(
        sitter,
        fabric,
        (
            lambda at: _NECKLINE.depth(sitter, at),
            lambda at: _WRIST - sitter.along_arm(at, "left"),
            lambda at: _WRIST - sitter.along_arm(at, "right"),
            lambda at: at[:, 1] - ankle - 0.02,
        ),
    )
    cloth = _smooth_trunk(sitter, cloth)
    whole, _ = thick(sitter, cloth.raised(0.006), 0.007)
    return sitter.piece("sweater", whole, part=TIGHTS, triangles=_SUIT_TRIANGLES)


def _smooth_trunk(sitter: Sitter, cloth: Patch) -> Patch:
    """Return `cloth` with a smooth trunk; smoothing would make limbs thin."""
    at = cloth.take(sitter.person.vertices)
    along = np.maximum(sitter.along_arm(at, "left"), sitter.along_arm(at, "right"))
    hips = sitter.joint("left_hip")[1]
    trunk = np.clip(1 - 3 * along, 0, 1) * np.clip((at[:, 1] - hips + 0.20) / 0.30, 0, 1)
    blend = sparse.diags_array(trunk) @ smoothed(cloth, _SMOOTHING_ROUNDS).blend
    blend = blend + sparse.diags_array(1 - trunk) @ cloth.blend
    smooth = replace(cloth, blend=sparse.csr_array(blend))
    return smooth.raised(_SHRUNK_BY * trunk)


def _head(sitter: Sitter) -> Piece:
    """Return head and neck as one smooth surface around an upright axis."""
    centre = head_centre(sitter)
    neck = sitter.joint("neck")
    body = np.unique(sitter.person.parts["body"])
    at = sitter.person.vertices[body]
    shown = (mask(sitter, "ears")[body] < 0.5) & (mask(sitter, "inside-mouth")[body] < 0.5)
    shown &= (at[:, 1] > neck[1] - 0.1) & (np.abs(at[:, 0]) < 0.12)
    at, source = at[shown], body[shown]
    turn = np.linspace(0, 2 * np.pi, _COLUMNS, endpoint=False)
    tilts = np.radians(np.linspace(88, 4, _UPPER_ROWS))
    heights = np.linspace(0.0, neck[1] - _BELOW_NECK - centre[1], _LOWER_ROWS)
    axis = np.stack(
        [np.zeros(_LOWER_ROWS), heights, np.linspace(0, neck[2] - centre[2], _LOWER_ROWS)], axis=1
    )
    origins = np.concatenate([np.zeros((_UPPER_ROWS, 3)), axis]) + centre
    rises = np.concatenate([tilts, np.zeros(_LOWER_ROWS)])
    directions = np.stack(
        [
            np.cos(rises)[:, None] * np.sin(turn),
            np.broadcast_to(np.sin(rises)[:, None], (len(rises), _COLUMNS)),
            np.cos(rises)[:, None] * np.cos(turn),
        ],
        axis=2,
    )
    reach = np.stack(
        [
            _reach(at, origin, along, rise)
            for origin, along, rise in zip(origins, directions, rises, strict=True)
        ]
    )
    reach = gaussian_filter(reach, _SMOOTHED_BY, mode=("nearest", "wrap"))
    vertices = (origins[:, None] + reach[..., None] * directions).reshape(-1, 3)
    weights = _weights(sitter, vertices, at, source)
    row, column = np.divmod(np.arange((len(rises) - 1) * _COLUMNS), _COLUMNS)
    a = row * _COLUMNS + column
    b = row * _COLUMNS + (column + 1) % _COLUMNS
    faces = np.concatenate(
        [np.stack([a, a + _COLUMNS, b], 1), np.stack([b, a + _COLUMNS, b + _COLUMNS], 1)]
    )
    lid = np.stack([[0, k, k + 1] for k in range(1, _COLUMNS - 1)])
    return Piece(
        material="skin",
        vertices=vertices,
        faces=np.concatenate([faces, lid]),
        weights=weights,
        actions=np.zeros((len(ARKIT_NAMES), len(vertices), 3)),
    )


def _reach(at: Array, origin: Array, directions: Array, rise: float) -> Array:
    """Return the distance from `origin` to the surface at points `at` by direction, in metres."""
    away = at - origin
    if rise > 0:
        length = np.linalg.norm(away, axis=1)
        outer = (length > 0.05) & (away[:, 1] > -0.03)
        tree = cKDTree(away[outer] / length[outer, None])
        distance, near = tree.query(directions, k=5)
        share = 1 / np.maximum(distance, 1e-3)
        return np.asarray((share * length[outer][near]).sum(axis=1) / share.sum(axis=1))
    level = np.abs(away[:, 1]) < 0.03
    flat = away[level] * [1, 0, 1]
    length = np.linalg.norm(flat, axis=1)
    outer = length > 0.03
    ring = flat[outer] / length[outer, None]
    # Height counts too, so that points at the same level determine the distance.
    where = np.column_stack([ring, 12 * away[level][outer, 1]])
    asked = np.column_stack([directions, np.zeros(len(directions))])
    distance, near = cKDTree(where).query(asked, k=5)
    share = 1 / np.maximum(distance, 1e-2)
    return np.asarray((share * length[outer][near]).sum(axis=1) / share.sum(axis=1))


def _weights(sitter: Sitter, vertices: Array, at: Array, source: NDArray[np.int64]) -> Array:
    """Return skin weights taken from the body."""
    distance, near = cKDTree(at).query(vertices, k=8)
    share = 1 / np.maximum(distance, 1e-3)
    share /= share.sum(axis=1, keepdims=True)
    return np.asarray(np.einsum("nk,nkj->nj", share, sitter.weights[source][near]))


def _without_jaw(weights: Array) -> Array:
    """Return skin weights with the jaw's moved to the head: there is no mouth to open."""
    result = weights.copy()
    result[:, joint_index("head")] += weights[:, joint_index("jaw")]
    result[:, joint_index("jaw")] = 0.0
    return result
