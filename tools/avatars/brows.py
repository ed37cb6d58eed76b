"""Eyebrows, cut out of the forehead and raised a little."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from tools.avatars.patch import Patch
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]

_SHAPE: Final = (
    # share of the way outwards, height above the eye, half the thickness, both in metres
    (0.0, 0.0200, 0.0022), (0.25, 0.0215, 0.0031), (0.6, 0.0240, 0.0027), (0.85, 0.0225, 0.0018),
    (1.0, 0.0195, 0.0008),
)  # fmt: skip
_INNER: Final = 0.0125
_LENGTH: Final = 0.0400
_TRIANGLES: Final = 240


def brows(sitter: Sitter, thickness: float) -> Piece:
    """Return both eyebrows, `thickness` times as thick as middling ones."""
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
