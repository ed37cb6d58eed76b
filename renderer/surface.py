"""What a body's surface looks like: its normals and its colours."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from motion.body import BodyModel
from motion.errors import InputError

FloatArray = NDArray[np.float32]

_GLEAM: Final = {
    "skin": 0.035, "lips": 0.10, "teeth": 0.10, "tongue": 0.08, "sclera": 0.10, "iris": 0.05,
    "limbus": 0.05, "pupil": 0.25, "hair": 0.05, "nails": 0.12, "shoes": 0.04,
}  # fmt: skip
"""How much each material mirrors the lights; none where not named."""

_COMMON: Final = {
    "teeth": "#ece7dd", "tongue": "#b06060", "mouth": "#5a2222", "sclera": "#f1efec",
    "pupil": "#0a0a0a", "lash": "#241a16", "soles": "#dcdcd8",
}  # fmt: skip

AVATARS: Final[Mapping[str, Mapping[str, str]]] = {
    "blue": {
        **_COMMON,
        "skin": "#dfab8e", "lips": "#c08472", "nails": "#e5b5a0", "iris": "#5b412c",
        "limbus": "#33241a", "brow": "#4d392b", "hair": "#3a2a1f", "sweater": "#3f6690",
        "trim": "#37597e", "trousers": "#343841", "shoes": "#4a4542",
    },
    "green": {
        **_COMMON,
        "skin": "#9a6a4b", "lips": "#84503f", "nails": "#b3836a", "iris": "#3c2818",
        "limbus": "#21160e", "brow": "#1d1511", "hair": "#1d1613", "sweater": "#557a5f",
        "trim": "#4a6c53", "trousers": "#3b3a38", "shoes": "#35312e",
    },
}  # fmt: skip
"""The colours in which the default body is dressed, by the avatar's name."""

MANNEQUIN: Final = "#a8a49f"
"""The one colour of a body that does not say what it is made of."""

_SHADE_STRENGTH: Final = 0.45


class VertexNormals:
    """Unit normals of one mesh in many poses.

    Vertices that share a place in the template share their normal, so that a border between two
    colours is no crease.
    """

    def __init__(self, body: BodyModel) -> None:
        self._faces = [np.ascontiguousarray(corner) for corner in body.faces.T]
        _, group = np.unique(np.round(body.template, 6), axis=0, return_inverse=True)
        self._group = group.reshape(-1)
        corners = self._group[body.faces].ravel()
        faces = np.repeat(np.arange(len(body.faces)), 3)
        self._sum = sparse.csr_array(
            (np.ones(len(corners), np.float32), (corners, faces)),
            shape=(int(self._group.max()) + 1, len(body.faces)),
        )

    def of(self, vertices: FloatArray) -> FloatArray:
        """Return the normals of `vertices`, both of shape (V, 3); larger faces count more."""
        # `take` gathers rows several times as fast as indexing does.
        first, second, third = (np.take(vertices, corner, axis=0) for corner in self._faces)
        second -= first
        third -= first
        total = self._sum @ _cross(second, third)
        length = np.sqrt(np.einsum("va,va->v", total, total))[:, None]
        return np.take(total / np.maximum(length, 1e-20), self._group, axis=0)


def avatar_colours(body: BodyModel, avatar: str) -> FloatArray:
    """Return each vertex's sRGB colour in [0, 1] and how much it gleams, shape (V, 4).

    Parameters
    ----------
    body : BodyModel
        The default body, or any other, which is then drawn in one plain colour.
    avatar : str
        One of `AVATARS`.

    Raises
    ------
    InputError
        If there is no such avatar.
    """
    if avatar not in AVATARS:
        raise InputError(
            f"there is no avatar {avatar!r}", remedy=f"Use one of {', '.join(sorted(AVATARS))}"
        )
    colours = np.zeros((len(body.template), 4), np.float32)
    if "material" not in body.surface:
        colours[:] = (*_srgb(MANNEQUIN), _GLEAM["skin"])
        return colours
    palette = AVATARS[avatar]
    table = np.array(
        [(*_srgb(palette[name]), _GLEAM.get(name, 0.0)) for name in body.surface["material_names"]]
    )
    colours[:] = table[body.surface["material"]]
    colours[:, :3] *= body.surface["shade"][:, None] ** _SHADE_STRENGTH
    return colours


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross products of rows; twice as fast as `numpy.cross` on float32."""
    result = np.empty_like(a)
    for axis, (left, right) in enumerate(((1, 2), (2, 0), (0, 1))):
        np.multiply(a[:, left], b[:, right], out=result[:, axis])
        result[:, axis] -= a[:, right] * b[:, left]
    return result


def _srgb(colour: str) -> tuple[float, float, float]:
    """Return ``#rrggbb`` as three values in [0, 1]."""
    red, green, blue = bytes.fromhex(colour[1:])
    return red / 255, green / 255, blue / 255
