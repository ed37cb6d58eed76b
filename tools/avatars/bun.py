"""A bun at the back of the head."""

from __future__ import annotations

from typing import Final

import numpy as np

from motion.face import ARKIT_NAMES
from motion.skeleton import JOINT_COUNT, joint_index
from tools.avatars.hair import head_centre
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

_PLACE: Final = (0.0, 0.075, -0.112)
"""Metres from the middle of the head."""

_RADII: Final = (0.043, 0.040, 0.034)
_ROWS: Final = 9
_SEGMENTS: Final = 14
_COILS: Final = 0.06


def bun(sitter: Sitter) -> Piece:
    """Return the bun."""
    tilt = np.linspace(0, np.pi, _ROWS)[:, None]
    turn = np.linspace(0, 2 * np.pi, _SEGMENTS, endpoint=False)[None]
    radius = 1 + _COILS * np.sin(3 * turn + 5 * tilt)
    ball = np.stack(
        [
            radius * np.sin(tilt) * np.cos(turn),
            radius * np.sin(tilt) * np.sin(turn),
            -np.cos(tilt) + 0 * turn,
        ],
        axis=2,
    ).reshape(-1, 3)
    back = np.array(_PLACE) / np.linalg.norm(_PLACE)
    across = np.array([1.0, 0.0, 0.0])
    axes = np.stack([across, np.cross(back, across), back]) * np.array(_RADII)[:, None]
    vertices = ball @ axes + head_centre(sitter) + np.array(_PLACE)
    row, column = np.divmod(np.arange((_ROWS - 1) * _SEGMENTS), _SEGMENTS)
    a = row * _SEGMENTS + column
    b = row * _SEGMENTS + (column + 1) % _SEGMENTS
    faces = np.concatenate(
        [np.stack([a, b, a + _SEGMENTS], 1), np.stack([b, b + _SEGMENTS, a + _SEGMENTS], 1)]
    )
    weights = np.zeros((len(vertices), JOINT_COUNT))
    weights[:, joint_index("head")] = 1.0
    light = 0.5 + 0.5 * np.sin(3 * turn + 5 * tilt).ravel()
    return Piece(
        material="hair",
        vertices=vertices,
        faces=faces,
        weights=weights,
        actions=np.zeros((len(ARKIT_NAMES), len(vertices), 3)),
        mixed={"hair_light": light},
    )
