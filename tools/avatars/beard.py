"""A short full beard with moustache, fading into the skin."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.spatial import cKDTree

from tools.avatars.masks import mask
from tools.avatars.patch import Patch, boundary_edges
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]

_UPPER_LINE: Final = (
    # metres aside of the middle, and above the corners of the mouth
    (0.0, 0.0185), (0.010, 0.0185), (0.020, 0.0125), (0.030, 0.006), (0.042, 0.006),
    (0.054, 0.020), (0.062, 0.045), (0.068, 0.075), (0.075, 0.085), (0.1, 0.085),
)  # fmt: skip
_DEPTH: Final = 0.0045
_FADE: Final = 0.010
_LIP_GAP: Final = 0.25
_TRIANGLES: Final = 800


def beard(sitter: Sitter) -> Piece:
    """Return the beard."""
    body = sitter.patch("body")
    near = body.touching(_within(sitter, body) > -0.01)
    near = near.refined(np.ones(len(near.faces), bool))
    grown = near.cut(_within(sitter, near))
    inside = np.clip(_within(sitter, grown) / _FADE, 0, 1)
    raised = grown.raised(0.0006 + _DEPTH * np.sqrt(inside))
    piece = sitter.piece("beard", raised, actions=True, triangles=_TRIANGLES)
    border = piece.vertices[np.unique(boundary_edges(piece.faces))]
    distance, _ = cKDTree(border).query(piece.vertices)
    return replace(piece, mixed={"skin": 0.9 * (1 - np.clip(distance / _FADE, 0, 1))})


def _within(sitter: Sitter, patch: Patch) -> Array:
    """Return how far inside the beard each vertex is, in metres; negative outside."""
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
