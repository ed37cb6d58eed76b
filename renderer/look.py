"""How every stimulus of a study looks: size, frame rate, framing, avatar, light."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from motion.errors import InputError
from renderer.avatars import FIRST, avatar_named

BACKGROUND: Final = (0xEC, 0xEC, 0xEE)
"""sRGB of the plain background; pages that show the videos use the same."""

FRAMINGS: Final = ("upper_body", "full_body")


@dataclass(frozen=True, kw_only=True)
class Light:
    """A light so far away that it shines in one direction.

    Attributes
    ----------
    comes_from : tuple of float
        Direction from the body to the light.
    colour : tuple of float
        Linear RGB in [0, 1].
    intensity : float
        What it adds to a surface that faces it.
    """

    comes_from: tuple[float, float, float]
    colour: tuple[float, float, float]
    intensity: float


LIGHTS: Final = (
    Light(comes_from=(-0.55, 0.75, 0.95), colour=(1.0, 0.97, 0.93), intensity=0.78),
    Light(comes_from=(0.95, 0.15, 0.55), colour=(0.90, 0.95, 1.0), intensity=0.26),
    Light(comes_from=(0.35, 0.65, -0.9), colour=(1.0, 1.0, 1.0), intensity=0.35),
)
"""A soft three-quarter key, a fill from the other side, and one from behind."""

AMBIENT_LIGHT: Final = (0.36, 0.365, 0.38)


@dataclass(frozen=True, kw_only=True)
class Look:
    """What all stimuli of a study share.

    Attributes
    ----------
    size : int
        Pixels along each side of a clip's video; even, 64 to 2160.
    frame_rate : float
        Frames per second of the videos.
    framing : str
        ``upper_body`` or ``full_body``.
    avatar : str
        One of `renderer.avatars.AVATARS`.
    expression_matrix : Path or None
        A file that `motion.body.expression_matrix` reads: turns the faces of clips into the body's
        terms.
    """

    size: int = 720
    frame_rate: float = 30.0
    framing: str = "upper_body"
    avatar: str = FIRST
    expression_matrix: Path | None = None

    def __post_init__(self) -> None:
        if not 64 <= self.size <= 2160 or self.size % 2:
            raise InputError(
                f"size {self.size} is not usable",
                remedy="Give an even number of pixels from 64 to 2160",
            )
        if not 1 <= self.frame_rate <= 120:
            raise InputError(
                f"frame rate {self.frame_rate} is not usable",
                remedy="Give 1 to 120 frames per second",
            )
        if self.framing not in FRAMINGS:
            raise InputError(
                f"unknown framing {self.framing!r}", remedy=f"Use one of {', '.join(FRAMINGS)}"
            )
        avatar_named(self.avatar)
