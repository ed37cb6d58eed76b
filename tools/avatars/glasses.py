"""Glasses: two rims without lenses, so that the eyes show, a bridge, and temples to the ears."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.clip import ARKIT_NAMES
from motion.skeleton import JOINT_COUNT, joint_index
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter, mask

Array = NDArray[np.float64]

_HALF_WIDTH: Final = 0.0245
_HALF_HEIGHT: Final = 0.0185
_BEFORE_EYES: Final = 0.027
_BELOW_EYES: Final = 0.002
_WRAP: Final = 0.16
"""Backward curve of the rims at the sides, in metres per metre."""

_WIRE: Final = 0.0013
_SIDES: Final = 4


def glasses(sitter: Sitter) -> Piece:
    """Return the glasses."""
    wires = []
    for side, outward in (("left", 1.0), ("right", -1.0)):
        eye = sitter.joint(f"{side}_eye") + np.array([0.0, -_BELOW_EYES, _BEFORE_EYES])
        turn = np.linspace(0, 2 * np.pi, 25)
        x = _HALF_WIDTH * np.sign(np.cos(turn)) * np.abs(np.cos(turn)) ** 0.7
        y = _HALF_HEIGHT * np.sign(np.sin(turn)) * np.abs(np.sin(turn)) ** 0.7
        rim = eye + np.stack([outward * x, y, -_WRAP * (x + _HALF_WIDTH) ** 1.0], axis=1)
        wires.append(rim)
        hinge = eye + np.array(
            [outward * _HALF_WIDTH, 0.55 * _HALF_HEIGHT, -2 * _WRAP * _HALF_WIDTH]
        )
        ear = _ear(sitter, outward)
        wide = np.array([ear[0] - outward * 0.001, hinge[1], hinge[2] - 0.022])
        behind = ear + np.array([-outward * 0.004, -0.012, -0.022])
        wires.append(
            np.stack([hinge, (hinge + wide) / 2 + [outward * 0.004, 0, 0.004], wide, ear, behind])
        )
    inner = [sitter.joint(f"{side}_eye") for side in ("left", "right")]
    ends = [
        inner[k] + np.array([sign * -_HALF_WIDTH, 0.25 * _HALF_HEIGHT, _BEFORE_EYES])
        for k, sign in ((0, 1.0), (1, -1.0))
    ]
    middle = (ends[0] + ends[1]) / 2 + np.array([0.0, 0.003, 0.003])
    wires.append(np.stack([ends[0], middle, ends[1]]))
    return _as_piece([_tube(wire) for wire in wires])


def _ear(sitter: Sitter, outward: float) -> Array:
    """Return the point where a temple rests on an ear."""
    at = sitter.person.vertices[(mask(sitter, "ears") > 0.5)]
    mine = at[at[:, 0] * outward > 0]
    top = mine[mine[:, 1] > mine[:, 1].max() - 0.010]
    return np.array([top[:, 0].mean() - outward * 0.004, top[:, 1].max() + 0.001, top[:, 2].mean()])


def _tube(line: Array) -> tuple[Array, NDArray[np.int64]]:
    """Return a thin tube along `line`, shape (n, 3)."""
    along = np.gradient(line, axis=0)
    if np.allclose(line[0], line[-1]):
        along[0] = along[-1] = line[1] - line[-2]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(
        along, np.where(np.abs(along[:, [1]]) > 0.9, [[0.0, 0.0, 1.0]], [[0.0, 1.0, 0.0]])
    )
    side = np.cross(along, [0.0, 0.0, 1.0]) if np.allclose(line[0], line[-1]) else side
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-9)
    up = np.cross(side, along)
    turn = 2 * np.pi * (np.arange(_SIDES) + 0.5) / _SIDES
    ring = np.cos(turn)[None, :, None] * side[:, None] + np.sin(turn)[None, :, None] * up[:, None]
    vertices = (line[:, None] + 1.41 * _WIRE * ring).reshape(-1, 3)
    row, column = np.divmod(np.arange((len(line) - 1) * _SIDES), _SIDES)
    a = row * _SIDES + column
    b = row * _SIDES + (column + 1) % _SIDES
    faces = np.concatenate(
        [np.stack([a, b, a + _SIDES], 1), np.stack([b, b + _SIDES, a + _SIDES], 1)]
    )
    return vertices, faces


def _as_piece(tubes: list[tuple[Array, NDArray[np.int64]]]) -> Piece:
    """Return all tubes as one piece attached to the head."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in tubes)])
    vertices = np.concatenate([vertices for vertices, _ in tubes])
    faces = np.concatenate([part + start for (_, part), start in zip(tubes, starts, strict=False)])
    weights = np.zeros((len(vertices), JOINT_COUNT))
    weights[:, joint_index("head")] = 1.0
    return Piece(
        material="glasses",
        vertices=vertices,
        faces=faces,
        weights=weights,
        actions=np.zeros((len(ARKIT_NAMES), len(vertices), 3)),
    )
