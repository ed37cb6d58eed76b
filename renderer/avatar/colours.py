"""What colour each vertex has: its material's, darker where little light comes."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from renderer.avatar.pieces import MATERIALS
from renderer.avatars import COMMON_COLOURS, Avatar

_GLEAM: Final = {
    "skin": 0.035, "lips": 0.10, "teeth": 0.10, "tongue": 0.08, "sclera": 0.10, "iris": 0.05,
    "limbus": 0.05, "pupil": 0.25, "hair": 0.05, "nails": 0.12, "shoes": 0.04,
}  # fmt: skip
"""How much each material mirrors the lights; none where not named."""

_SHADE_STRENGTH: Final = 0.45


def baked_colours(
    avatar: Avatar, material: NDArray[np.integer], shade: NDArray[np.floating]
) -> NDArray[np.uint8]:
    """Return each vertex's sRGB colour and how much it gleams, each in 0-255, shape (V, 4).

    Parameters
    ----------
    avatar : Avatar
        Whose palette gives the colours.
    material : ndarray, shape (V,)
        Indices into `MATERIALS`.
    shade : ndarray, shape (V,)
        How bright each vertex is where light comes from everywhere, in [0, 1].
    """
    palette = {**COMMON_COLOURS, **avatar.palette}
    table = np.array(
        [
            (*bytes.fromhex(palette[name][1:]), 255 * _GLEAM.get(name, 0.0))
            if name in palette
            else (0, 0, 0, 0)
            for name in MATERIALS
        ]
    )
    colours = table[material]
    colours[:, :3] *= np.asarray(shade)[:, None] ** _SHADE_STRENGTH
    return np.asarray(np.round(colours), np.uint8)
