"""Head and neck: skin with lips, and the inside of the mouth."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tools.avatars.necklines import Neckline
from tools.avatars.patch import Patch
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter, mask

Array = NDArray[np.float64]

_TRIANGLES: Final = 4300
_MOUTH_TRIANGLES: Final = 260
_TONGUE_TRIANGLES: Final = 120

_FEATURE_IMPORTANCE: Final = 6.0
_UNSEEN_IMPORTANCE: Final = 0.15
_TUCKED_IN: Final = 0.015
"""Metres by which skin under cloth is lowered, so that it does not poke through."""

_BLUSH: Final = (
    # offset aside, above and in front of the eyes' middle; width; strength
    ((0.042, -0.040, 0.0), 0.020, 0.55), ((0.0, -0.046, 0.03), 0.014, 0.45),
    ((0.0, -0.115, 0.0), 0.016, 0.20), ((0.075, -0.03, -0.09), 0.022, 0.45),
)  # fmt: skip


def head(sitter: Sitter, neckline: Neckline) -> list[Piece]:
    """Return head and neck down into the neckline, and the inside of the mouth."""
    body = sitter.patch("body")
    at = body.take(sitter.person.vertices)
    below = neckline.depth(sitter, at)
    skin = body.inside((below < 0.045) & (np.abs(at[:, 0]) < 0.16))
    below = neckline.depth(sitter, skin.take(sitter.person.vertices))
    skin = skin.raised(-_TUCKED_IN * np.clip((below - 0.004) / 0.02, 0, 1))
    skin, red = skin.split(skin.take(mask(sitter, "lips")) - 0.5)
    inside: Array = skin.take(mask(sitter, "inside-mouth"))[skin.faces].mean(axis=1)
    mouth = inside > 0.5
    lip = ~mouth & (red[skin.faces].sum(axis=1) > 0)
    face = sitter.pieces(
        skin.keeping(~mouth),
        {"skin": ~lip[~mouth], "lips": lip[~mouth]},
        actions=True,
        triangles=_TRIANGLES,
        importance=_importance(sitter),
        mixed={"blush": _blush(sitter)},
    )
    return [
        *face,
        sitter.piece("mouth", skin.keeping(mouth), actions=True, triangles=_MOUTH_TRIANGLES),
        sitter.piece("teeth", _teeth(sitter), actions=True),
        sitter.piece(
            "tongue", sitter.patch("helper-tongue"), actions=True, triangles=_TONGUE_TRIANGLES
        ),
    ]


def _teeth(sitter: Sitter) -> Patch:
    """Return the fronts of the teeth; their backs are never visible."""
    rows = sitter.patch("helper-upper-teeth", "helper-lower-teeth")
    at = rows.take(sitter.person.vertices)
    corners = at[rows.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    outwards = (corners.mean(axis=1) - [0.0, 0.0, at[:, 2].min()]) * [1, 0, 1]
    outwards /= np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-12)
    return rows.keeping((normals * outwards).sum(axis=1) > 0.4)


def _importance(sitter: Sitter) -> Array:
    """Return the weight of an error at each source vertex, largest around eyes and mouth."""
    at = sitter.person.vertices
    eyes = sitter.joint("left_eye")
    mouth = np.array([0.0, eyes[1] - 0.07, eyes[2] + 0.02])
    result = np.ones(len(at))
    for centre, radius in ((eyes, 0.04), (eyes * [-1, 1, 1], 0.04), (mouth, 0.05)):
        near = np.clip(1.6 - np.linalg.norm(at - centre, axis=1) / radius, 0, 1)
        result = np.maximum(result, 1 + (_FEATURE_IMPORTANCE - 1) * near)
    scalp = np.clip((eyes[2] - 0.05 - at[:, 2]) / 0.03, 0, 1) * (at[:, 1] > eyes[1] - 0.02)
    unseen = np.maximum(scalp, mask(sitter, "ears") > 0.5)
    return np.asarray(result * (1 - (1 - _UNSEEN_IMPORTANCE) * unseen))


def _blush(sitter: Sitter) -> Array:
    """Return the redness of each source vertex: cheeks, nose, chin and ears."""
    eyes = (sitter.joint("left_eye") + sitter.joint("right_eye")) / 2
    at = (sitter.person.vertices - eyes) * [1, 1, 0.6]
    at[:, 0] = np.abs(at[:, 0])
    result = np.zeros(len(at))
    for centre, width, strength in _BLUSH:
        distance = np.linalg.norm(at - np.array(centre) * [1, 1, 0.6], axis=1)
        result = np.maximum(result, strength * np.exp(-((distance / width) ** 2)))
    return result
