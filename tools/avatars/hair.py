"""Hair that lies on the scalp above the hairline, lifted and combed, and a bun at its back."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from motion.clip import ARKIT_NAMES
from motion.skeleton import JOINT_COUNT, joint_index
from tools.avatars.patch import Patch, boundary_edges, hemmed
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter, mask

Array = NDArray[np.float64]
Line = tuple[tuple[float, float], ...]

_TRIANGLES: Final = 1400

_EVEN: Final[Line] = (
    # degrees round the head from the front, height above the eyes in metres
    (0, 0.072), (22, 0.074), (40, 0.064), (54, 0.046), (64, 0.022), (72, 0.000), (78, -0.014),
    (84, -0.008), (92, 0.016), (104, 0.010), (116, -0.020), (130, -0.055), (150, -0.072),
    (180, -0.078),
)  # fmt: skip
_RECEDING: Final[Line] = (
    (0, 0.084), (14, 0.086), (30, 0.096), (42, 0.088), (54, 0.060), (64, 0.030), (72, 0.004),
    (78, -0.012), (84, -0.008), (92, 0.016), (104, 0.010), (116, -0.020), (130, -0.052),
    (150, -0.066), (180, -0.070),
)  # fmt: skip
_UP: Final[Line] = (
    (0, 0.074), (22, 0.075), (40, 0.066), (54, 0.048), (66, 0.020), (74, -0.004), (82, -0.004),
    (92, 0.016), (104, 0.008), (116, -0.022), (130, -0.048), (150, -0.056), (180, -0.060),
)  # fmt: skip

_PLACE: Final = (0.0, 0.075, -0.112)
"""Metres from the middle of the head."""

_RADII: Final = (0.043, 0.040, 0.034)
_ROWS: Final = 9
_SEGMENTS: Final = 14
_COILS: Final = 0.06


@dataclass(frozen=True, kw_only=True)
class Cut:
    """The cut of hair on the scalp.

    Attributes
    ----------
    hairline : tuple
        Height above the eyes, in metres, by degrees round the head from the front.
    sides, top, front : float
        Thickness at the sides and on top, and what is added above the forehead, in metres.
    edge : float
        Metres from the hairline over which it rises to that thickness.
    waves : float
        Unevenness as a share of its thickness.
    parting : float or None
        Metres of the parting to the body's left of the middle.
    """

    hairline: Line
    sides: float
    top: float
    front: float = 0.0
    edge: float = 0.03
    waves: float = 0.05
    parting: float | None = None


CUTS: Final[Mapping[str, Cut]] = MappingProxyType({
    "short": Cut(hairline=_EVEN, sides=0.007, top=0.020, front=0.006, parting=0.030),
    "cropped": Cut(hairline=_EVEN, sides=0.003, top=0.006, edge=0.02, waves=0.0),
    "receding": Cut(hairline=_RECEDING, sides=0.008, top=0.011, front=0.003, waves=0.08),
    "swept": Cut(hairline=_EVEN, sides=0.006, top=0.024, front=0.012, waves=0.04),
    "bun": Cut(hairline=_UP, sides=0.006, top=0.010, edge=0.02, waves=0.03),
})  # fmt: skip


def hair_on_scalp(sitter: Sitter, cut: Cut) -> Piece:
    """Return the hair of `cut`."""
    body = sitter.patch("body")
    at = body.take(sitter.person.vertices) - head_centre(sitter)
    scalp = body.touching((_above(sitter, body, cut) > -0.012) & (at[:, 1] > -0.1))
    scalp = scalp.refined(np.ones(len(scalp.faces), bool))
    scalp = scalp.cut(_above(sitter, scalp, cut))
    hair = scalp.raised(_lift(sitter, scalp, cut))
    return sitter.piece(
        "hair",
        hemmed(hair, boundary_edges(hair.faces), 0.012),
        actions=True,
        triangles=_TRIANGLES,
        mixed={"hair_light": _strands(sitter)},
    )


def head_centre(sitter: Sitter) -> Array:
    """Return the middle of the skull at the height of the eyes."""
    eyes = (sitter.joint("left_eye") + sitter.joint("right_eye")) / 2
    return np.asarray(eyes - np.array([0.0, 0.0, 0.075]))


def _lift(sitter: Sitter, scalp: Patch, cut: Cut) -> Array:
    """Return the thickness of the hair at each vertex of the scalp."""
    at = scalp.take(sitter.person.vertices) - head_centre(sitter)
    inwards = np.clip(_above(sitter, scalp, cut) / cut.edge, 0, 1)
    rounded = np.sqrt(1 - (1 - inwards) ** 2)
    top = _smooth(at[:, 1] / 0.09)
    forward = _smooth((at[:, 2] - 0.02) / 0.05)
    thick = cut.sides + (cut.top - cut.sides) * top + cut.front * forward * top
    if cut.parting is not None:
        across = at[:, 0] - cut.parting - 0.12 * np.clip(-at[:, 2], 0, 1)
        swell = np.tanh(np.abs(across) / 0.012)
        thick = thick * (1 - 0.30 * (1 - swell) * top * (at[:, 2] > -0.03))
        thick = thick * np.where(across > 0, 0.85, 1.0)
    waves = np.sin(190 * at[:, 0] + 60 * at[:, 2] + 2 * np.sin(40 * at[:, 1]))
    return np.asarray(np.maximum(0.0010 + rounded * thick * (1 + cut.waves * waves), 0.001))


def _strands(sitter: Sitter) -> Array:
    """Return how much lighter the hair is at each source vertex, so that it looks less moulded."""
    at = sitter.person.vertices - head_centre(sitter)
    across = np.arctan2(at[:, 0], np.maximum(at[:, 1] + 0.06, 1e-3))
    wave = np.sin(17 * across + 1.3 * np.sin(30 * at[:, 2])) * np.sin(41 * across + 25 * at[:, 2])
    return np.asarray(0.5 + 0.5 * wave)


def _above(sitter: Sitter, patch: Patch, cut: Cut) -> Array:
    """Return the height of the patch's vertices above the hairline, in metres; ears are below."""
    at = patch.take(sitter.person.vertices) - head_centre(sitter)
    angle = np.degrees(np.arctan2(np.abs(at[:, 0]), at[:, 2]))
    line = PchipInterpolator(*np.array(cut.hairline).T)(angle)
    ears = patch.take(mask(sitter, "ears"))
    return np.asarray(np.minimum(at[:, 1] - line, 0.02 * (0.5 - ears) + 0.01))


def _smooth(share: Array) -> Array:
    inside = np.clip(share, 0, 1)
    return np.asarray(inside * inside * (3 - 2 * inside))


def bun(sitter: Sitter) -> Piece:
    """Return the bun."""
    tilt = np.linspace(0, np.pi, _ROWS)[:, None]
    turn = np.linspace(0, 2 * np.pi, _SEGMENTS, endpoint=False)[None]
    radius = 1 + _COILS * np.sin(3 * turn + 5 * tilt)
    ball = np.stack(
        [
            radius * np.sin(tilt) * np.cos(turn),
            radius * np.sin(tilt) * np.sin(turn),
            -np.cos(tilt) + 0 * turn,
        ],
        axis=2,
    ).reshape(-1, 3)
    back = np.array(_PLACE) / np.linalg.norm(_PLACE)
    across = np.array([1.0, 0.0, 0.0])
    axes = np.stack([across, np.cross(back, across), back]) * np.array(_RADII)[:, None]
    vertices = ball @ axes + head_centre(sitter) + np.array(_PLACE)
    row, column = np.divmod(np.arange((_ROWS - 1) * _SEGMENTS), _SEGMENTS)
    a = row * _SEGMENTS + column
    b = row * _SEGMENTS + (column + 1) % _SEGMENTS
    faces = np.concatenate(
        [np.stack([a, b, a + _SEGMENTS], 1), np.stack([b, b + _SEGMENTS, a + _SEGMENTS], 1)]
    )
    weights = np.zeros((len(vertices), JOINT_COUNT))
    weights[:, joint_index("head")] = 1.0
    light = 0.5 + 0.5 * np.sin(3 * turn + 5 * tilt).ravel()
    return Piece(
        material="hair",
        vertices=vertices,
        faces=faces,
        weights=weights,
        actions=np.zeros((len(ARKIT_NAMES), len(vertices), 3)),
        mixed={"hair_light": light},
    )
