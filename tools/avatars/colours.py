"""What colour each vertex has: its material's, darker where little light comes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from tools.avatars.pieces import Piece
from tools.avatars.recipes import COMMON_COLOURS, Recipe

Array = NDArray[np.float64]

_GLEAM: Final = {
    "skin": 0.035, "lips": 0.10, "teeth": 0.10, "tongue": 0.08, "sclera": 0.10, "iris": 0.05,
    "limbus": 0.05, "pupil": 0.25, "hair": 0.05, "nails": 0.12, "shoes": 0.04, "glasses": 0.2,
    "buttons": 0.1,
}  # fmt: skip
"""How much each material mirrors the lights; none where not named."""

_SHADE_STRENGTH: Final = 0.45
_LEAST_SHADE: Final = {"teeth": 0.9, "tongue": 0.7}
"""What a closed mouth hides from the sky is not dark when the mouth opens."""


def baked_colours(recipe: Recipe, pieces: Sequence[Piece], shade: Array) -> NDArray[np.uint8]:
    """Return each vertex's sRGB colour and how much it gleams, each in 0-255, shape (V, 4).

    Parameters
    ----------
    recipe : Recipe
        Whose palette gives the colours.
    pieces : sequence of Piece
        All of the body, V vertices together.
    shade : ndarray, shape (V,)
        How bright each vertex is where light comes from everywhere, in [0, 1].

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
            remedy="Add it to its palette in tools/avatars/recipes.py",
        )
    return np.array(list(bytes.fromhex(palette[material][1:])), dtype=float)
