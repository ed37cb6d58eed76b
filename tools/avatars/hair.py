"""Hair that lies on the scalp: the scalp above the hairline, lifted and combed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from tools.avatars.masks import mask
from tools.avatars.patch import Patch, boundary_edges, hemmed
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

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


@dataclass(frozen=True, kw_only=True)
class Cut:
    """How hair on the scalp is cut.

    Attributes
    ----------
    hairline : tuple
        Height above the eyes, in metres, by degrees round the head from the front.
    sides, top, front : float
        How far it stands off at the sides, on top, and what is added above the forehead, metres.
    edge : float
        Metres from the hairline over which it rises to that.
    waves : float
        How uneven it is, as a share of its thickness.
    parting : float or None
        Metres from the middle to the body's left at which it parts.
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
    """Return how far the hair stands off at each vertex of the scalp."""
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
    """Return how much lighter each source vertex's hair is, so that it does not look moulded."""
    at = sitter.person.vertices - head_centre(sitter)
    across = np.arctan2(at[:, 0], np.maximum(at[:, 1] + 0.06, 1e-3))
    wave = np.sin(17 * across + 1.3 * np.sin(30 * at[:, 2])) * np.sin(41 * across + 25 * at[:, 2])
    return np.asarray(0.5 + 0.5 * wave)


def _above(sitter: Sitter, patch: Patch, cut: Cut) -> Array:
    """Return how far above the hairline the patch's vertices are, in metres; ears are below."""
    at = patch.take(sitter.person.vertices) - head_centre(sitter)
    angle = np.degrees(np.arctan2(np.abs(at[:, 0]), at[:, 2]))
    line = PchipInterpolator(*np.array(cut.hairline).T)(angle)
    ears = patch.take(mask(sitter, "ears"))
    return np.asarray(np.minimum(at[:, 1] - line, 0.02 * (0.5 - ears) + 0.01))


def _smooth(share: Array) -> Array:
    inside = np.clip(share, 0, 1)
    return np.asarray(inside * inside * (3 - 2 * inside))
