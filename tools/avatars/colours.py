"""The colour of each vertex: its material's, darkened where little light reaches it."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from tools.avatars.patch import vertex_normals
from tools.avatars.pieces import Piece
from tools.avatars.recipes import COMMON_COLOURS, Recipe

Array = NDArray[np.float64]

_GLEAM: Final = {
    "skin": 0.035, "lips": 0.10, "teeth": 0.10, "tongue": 0.08, "sclera": 0.10, "iris": 0.05,
    "limbus": 0.05, "pupil": 0.25, "hair": 0.05, "nails": 0.12, "shoes": 0.04, "glasses": 0.2,
    "buttons": 0.1,
}  # fmt: skip
"""Gloss of each material; others have none."""

_SHADE_STRENGTH: Final = 0.45
_LEAST_SHADE: Final = {"teeth": 0.9, "tongue": 0.7}
"""Least brightness of materials that a closed mouth hides from the sky."""

_DIRECTIONS: Final = 72
_CELL: Final = 0.004
_TOLERANCE: Final = 0.003
_MOST_SLANT: Final = 4.0
_CORNERS: Final = (
    np.array([(a, b, 4 - a - b) for a in range(5) for b in range(5 - a)], dtype=float) / 4
)  # barycentric points that cover a triangle


def baked_colours(recipe: Recipe, pieces: Sequence[Piece], shade: Array) -> NDArray[np.uint8]:
    """Return each vertex's sRGB colour and gloss, each in 0-255, shape (V, 4).

    Parameters
    ----------
    recipe : Recipe
        The recipe with the palette.
    pieces : sequence of Piece
        The whole body, V vertices together.
    shade : ndarray, shape (V,)
        Brightness of each vertex under light from everywhere, in [0, 1].

    Raises
    ------
    InputError
        If the palette lacks a material's colour.
    """
    palette = {**COMMON_COLOURS, **recipe.palette}
    result = []
    for piece in pieces:
        colour = np.tile(_srgb(palette, piece.material, recipe), (len(piece.vertices), 1))
        for name, share in piece.mixed.items():
            if name in palette:
                colour += share[:, None] * (_srgb(palette, name, recipe) - colour)
        gleam = np.full((len(colour), 1), 255 * _GLEAM.get(piece.material, 0.0))
        result.append(np.hstack([colour, gleam]))
    colours = np.concatenate(result)
    inside = np.repeat(
        [_LEAST_SHADE.get(piece.material, 0.0) for piece in pieces],
        [len(piece.vertices) for piece in pieces],
    )
    colours[:, :3] *= np.maximum(shade, inside)[:, None] ** _SHADE_STRENGTH
    return np.asarray(np.round(colours), np.uint8)


def _srgb(palette: Mapping[str, str], material: str, recipe: Recipe) -> Array:
    """Return the colour of `material`, shape (3,), each in 0-255."""
    if material not in palette:
        raise InputError(
            f"avatar {recipe.name} has no colour for {material}",
            remedy="Add one to its palette in tools/avatars/recipes.py",
        )
    return np.array(list(bytes.fromhex(palette[material][1:])), dtype=float)


def open_sky(vertices: Array, faces: NDArray[np.int64]) -> Array:
    """Return the share of the hemisphere over each vertex that nothing blocks.

    From each of many directions the surface is splatted into a depth grid; a vertex deeper than its
    cell is in shadow.

    Parameters
    ----------
    vertices : ndarray, shape (V, 3)
        Positions in metres.
    faces : ndarray, shape (F, 3)
        Triangles.

    Returns
    -------
    ndarray, shape (V,)
        Visible share, weighted by the cosine: 0 if all is blocked, 1 if nothing is.
    """
    normals = vertex_normals(vertices, faces)
    samples = np.einsum("kc,fcd->fkd", _CORNERS, vertices[faces]).reshape(-1, 3)
    seen, possible = np.zeros(len(vertices)), np.full(len(vertices), 1e-9)
    for direction in _sphere(_DIRECTIONS):
        across = np.cross(direction, [0.36, 0.48, 0.8])
        across /= np.linalg.norm(across)
        axes = np.stack([across, np.cross(direction, across)], axis=1)
        across_samples, height = samples @ axes, samples @ direction
        low = across_samples.min(axis=0)
        cells = ((across_samples - low) / _CELL).astype(np.int64)
        width = cells[:, 0].max() + 1
        depth = np.full(width * (cells[:, 1].max() + 1), -np.inf)
        highest_last = np.argsort(height)
        depth[(cells[:, 1] * width + cells[:, 0])[highest_last]] = height[highest_last]
        mine = np.round((vertices @ axes - low) / _CELL - 0.5).astype(int)
        mine = np.maximum(mine, 0)
        facing = np.maximum(normals @ direction, 0.0)
        # At a slant, the surface itself spans a range of depths in one cell.
        slant = np.minimum(
            np.sqrt(np.maximum(1 - facing**2, 0)) / np.maximum(facing, 1e-3), _MOST_SLANT
        )
        allowed = _TOLERANCE + 1.5 * _CELL * slant
        free = depth[mine[:, 1] * width + mine[:, 0]] < vertices @ direction + allowed
        seen += facing * free
        possible += facing
    return np.asarray(seen / possible)


def _sphere(count: int) -> Array:
    """Return `count` directions spread evenly over the sphere (Fibonacci's spiral)."""
    step = np.arange(count) + 0.5
    height = 1 - 2 * step / count
    turn = np.pi * (1 + 5**0.5) * step
    across = np.sqrt(1 - height**2)
    return np.stack([across * np.cos(turn), height, across * np.sin(turn)], axis=1)
