"""Eyebrows, raised a little from the forehead, and a short full beard that fades into the skin."""

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.spatial import cKDTree

from tools.avatars.patch import Patch, boundary_edges
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter, mask

Array = NDArray[np.float64]

_SHAPE: Final = (
    # share of the way outwards, height above the eye, half the thickness, both in metres
    (0.0, 0.0200, 0.0022), (0.25, 0.0215, 0.0031), (0.6, 0.0240, 0.0027), (0.85, 0.0225, 0.0018),
    (1.0, 0.0195, 0.0008),
)  # fmt: skip
_INNER: Final = 0.0125
_LENGTH: Final = 0.0400
_TRIANGLES: Final = 240

_UPPER_LINE: Final = (
    # metres aside of the middle, and above the corners of the mouth
    (0.0, 0.0185), (0.010, 0.0185), (0.020, 0.0125), (0.030, 0.006), (0.042, 0.006),
    (0.054, 0.020), (0.062, 0.045), (0.068, 0.075), (0.075, 0.085), (0.1, 0.085),
)  # fmt: skip
_DEPTH: Final = 0.0045
_FADE: Final = 0.010
_LIP_GAP: Final = 0.25
_BEARD_TRIANGLES: Final = 800


def brows(sitter: Sitter, thickness: float) -> Piece:
    """Return both eyebrows, `thickness` times as thick as average."""
    eye = sitter.joint("left_eye")
    line = PchipInterpolator(*np.array([row[:2] for row in _SHAPE]).T)
    half = PchipInterpolator(*np.array([(row[0], row[2]) for row in _SHAPE]).T)

    def within(patch: Patch) -> Array:
        at = patch.take(sitter.person.vertices)
        share = (np.abs(at[:, 0]) - _INNER) / _LENGTH
        inside = np.clip(share, 0, 1)
        across = thickness * half(inside) - np.abs(at[:, 1] - eye[1] - line(inside))
        ends = _LENGTH * np.minimum(share, 1 - share)
        return np.where(at[:, 2] > eye[2] - 0.03, np.minimum(across, ends), -1.0)

    body = sitter.patch("body")
    hairs = body.touching(within(body) > -0.012)
    for _ in range(2):
        hairs = hairs.refined(np.ones(len(hairs.faces), bool))
    hairs = hairs.cut(within(hairs))
    raised = 0.0004 + 0.0012 * np.clip(within(hairs) / 0.002, 0, 1)
    return sitter.piece("brow", hairs.raised(raised), actions=True, triangles=_TRIANGLES)


def beard(sitter: Sitter) -> Piece:
    """Return the beard."""
    body = sitter.patch("body")
    near = body.touching(_within(sitter, body) > -0.01)
    near = near.refined(np.ones(len(near.faces), bool))
    grown = near.cut(_within(sitter, near))
    inside = np.clip(_within(sitter, grown) / _FADE, 0, 1)
    raised = grown.raised(0.0006 + _DEPTH * np.sqrt(inside))
    piece = sitter.piece("beard", raised, actions=True, triangles=_BEARD_TRIANGLES)
    border = piece.vertices[np.unique(boundary_edges(piece.faces))]
    distance, _ = cKDTree(border).query(piece.vertices)
    return replace(piece, mixed={"skin": 0.9 * (1 - np.clip(distance / _FADE, 0, 1))})


def _within(sitter: Sitter, patch: Patch) -> Array:
    """Return each vertex's depth inside the beard, in metres; negative outside."""
    at = patch.take(sitter.person.vertices)
    lips = mask(sitter, "lips") > 0.5
    mouth = sitter.person.vertices[lips & (np.abs(sitter.person.vertices[:, 0]) < 0.03)]
    corners = float(np.median(mouth[:, 1]))
    front = float(mouth[:, 2].max())
    line = PchipInterpolator(*np.array(_UPPER_LINE).T)
    aside = np.abs(at[:, 0])
    below = corners + line(np.clip(aside, 0, 0.1)) - at[:, 1]
    throat = at[:, 1] - (corners - 0.052 + 0.30 * (front - 0.02 - at[:, 2]))
    clear = 0.012 * (_LIP_GAP - patch.take(mask(sitter, "lips")))
    ears = 0.012 * (0.3 - patch.take(mask(sitter, "ears")))
    before_ear = at[:, 2] - (front - 0.105 + 0.25 * np.clip(corners - at[:, 1], 0, 1))
    skin = 0.012 * (0.3 - patch.take(mask(sitter, "inside-mouth")))
    return np.asarray(
        np.minimum.reduce([below, throat, clear + 0.002, ears + 0.006, skin + 0.006, before_ear])
    )
