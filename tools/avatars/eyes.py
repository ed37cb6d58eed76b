"""Eyeballs with clean rings, turned by the eye joints and ARKit's looks; lashes and brows."""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.clip import ARKIT_NAMES
from motion.skeleton import JOINT_COUNT, joint_index
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]

_SEGMENTS: Final = 20
_RINGS: Final = (
    # from material's start to its end, degrees off the line of sight, and rings in between
    ("pupil", 0.0, 10.5, 1),
    ("iris", 10.5, 25.0, 1),
    ("limbus", 25.0, 28.5, 1),
    ("sclera", 28.5, 84.0, 3),
)
_CORNEA: Final = 0.06
"""Bulge of the iris as a share of the radius."""


def eyeballs(sitter: Sitter) -> list[Piece]:
    """Return both eyeballs, each in rings of one material."""
    return [
        _ring(sitter, side, material, start, end, count)
        for side in ("left", "right")
        for material, start, end, count in _RINGS
    ]


def lashes(sitter: Sitter) -> list[Piece]:
    """Return the upper eyelashes."""
    return [
        sitter.piece("lash", sitter.patch(f"helper-{side}-eyelashes-2"), actions=True)
        for side in ("l", "r")
    ]


def _ring(sitter: Sitter, side: str, material: str, start: float, end: float, count: int) -> Piece:
    """Return the part of one eyeball between two angles off its line of sight."""
    ball = sitter.person.vertices[np.unique(sitter.person.parts[f"helper-{side[0]}-eye"])]
    radius = float(np.ptp(ball, axis=0).mean() / 2)
    tilt = np.radians(np.linspace(start, end, count + 1))
    turn = np.linspace(0, 2 * np.pi, _SEGMENTS, endpoint=False)
    bulge = 1 + _CORNEA * np.clip(1 - (np.degrees(tilt) / 30) ** 2, 0, 1)
    across = np.outer(np.sin(tilt) * bulge, np.cos(turn)).ravel()
    upwards = np.outer(np.sin(tilt) * bulge, np.sin(turn)).ravel()
    forward = np.outer(np.cos(tilt) * bulge, np.ones(_SEGMENTS)).ravel()
    offsets = radius * np.stack([across, upwards, forward], axis=1)
    first = np.arange(count * _SEGMENTS)
    right = first - first % _SEGMENTS + (first + 1) % _SEGMENTS
    below, below_right = first + _SEGMENTS, right + _SEGMENTS
    faces = np.concatenate(
        [np.stack([first, below, right], axis=1), np.stack([right, below, below_right], axis=1)]
    )
    if start == 0:  # the innermost ring is a point
        offsets = offsets[_SEGMENTS - 1 :]
        faces = np.maximum(faces[faces.min(axis=1) >= 0] - (_SEGMENTS - 1), 0)
        faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    weights = np.zeros((len(offsets), JOINT_COUNT))
    weights[:, joint_index(f"{side}_eye")] = 1.0
    return Piece(
        material=material,
        vertices=sitter.joint(f"{side}_eye") + offsets,
        faces=faces,
        weights=weights,
        actions=_looks(sitter, side, offsets),
    )


def _looks(sitter: Sitter, side: str, offsets: Array) -> Array:
    """Return each facial action's offsets of the eyeball, which turns as Anny's own does."""
    indices = np.unique(sitter.person.parts[f"helper-{side[0]}-eye"])
    ball = sitter.person.vertices[indices] - sitter.joint(f"{side}_eye")
    moves = np.zeros((len(ARKIT_NAMES), len(offsets), 3))
    for number, action in enumerate(sitter.actions):
        moved = ball + action[indices]
        if np.abs(action[indices]).max() < 1e-5:
            continue
        rotation, _ = Rotation.align_vectors(moved - moved.mean(axis=0), ball - ball.mean(axis=0))
        moves[number] = rotation.apply(offsets) - offsets
    return moves
