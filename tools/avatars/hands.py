"""Hands and bare arms."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter, mask

Array = NDArray[np.float64]

_TRIANGLES_A_HAND: Final = 1600
_TRIANGLES_AN_ARM: Final = 250
_INTO_SLEEVE: Final = 0.34
_NEAR_END: Final = 0.04
_TUCKED_IN: Final = 0.009
_NAIL_IMPORTANCE: Final = 0.3
_FINGER_IMPORTANCE: Final = 3.0


def arms(sitter: Sitter, sleeve: float) -> list[Piece]:
    """Return the skin of both arms, hands included, with nails.

    Parameters
    ----------
    sitter : Sitter
        The person.
    sleeve : float
        End of the sleeves: 0 at the shoulder, 1 at the elbow, 2 at the wrist. Skin begins deep in
        the sleeve, out of sight, and is low enough there not to poke through.
    """
    at = sitter.person.vertices
    along = np.maximum(sitter.along_arm(at, "left"), sitter.along_arm(at, "right"))
    body = sitter.patch("body")
    skin = body.inside(body.take(along) > sleeve - _INTO_SLEEVE)
    covered = np.clip((sleeve - _NEAR_END - skin.take(along)) / 0.1, 0, 1)
    skin = skin.raised(-_TUCKED_IN * covered)
    skin, field = skin.split(skin.take(mask(sitter, "fingernails")) - 0.5)
    nail = field[skin.faces].sum(axis=1) > 0
    importance = np.where(along > 2.02, _FINGER_IMPORTANCE, 1.0)
    importance *= np.where(mask(sitter, "fingernails") > 0.5, _NAIL_IMPORTANCE, 1.0)
    bare = max(0.0, 1.98 - sleeve)
    return sitter.pieces(
        skin,
        {"skin": ~nail, "nails": nail},
        triangles=round(2 * (_TRIANGLES_A_HAND + bare * _TRIANGLES_AN_ARM)),
        importance=importance,
        mixed={"palm": _palm(sitter)},
    )


def _palm(sitter: Sitter) -> Array:
    """Return to what degree each source vertex is on a palm or a finger's inside, in [0, 1]."""
    normals = sitter.outwards("body")
    result = np.zeros(len(normals))
    for side, outward in (("left", 1.0), ("right", -1.0)):
        wrist = sitter.joint(f"{side}_wrist")
        middle, index, pinky = (sitter.joint(f"{side}_{f}1") for f in ("middle", "index", "pinky"))
        palm = np.cross(middle - wrist, index - pinky) * outward
        palm /= np.linalg.norm(palm)
        along = sitter.along_arm(sitter.person.vertices, side)
        facing = np.clip((normals @ palm - 0.2) / 0.5, 0, 1)
        result = np.maximum(result, facing * np.clip((along - 2.0) / 0.08, 0, 1))
    return result
