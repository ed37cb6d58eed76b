"""The windows in which a network sees motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from motion.clip import check_frame_rate
from motion.errors import InputError

LARGEST: Final = 10_000
"""Of any size of a network; a file that asks for more is damaged."""


@dataclass(frozen=True, kw_only=True)
class WindowConfig:
    """The windows in which a network sees motion.

    Attributes
    ----------
    frame_rate : float
        Frames per second to which clips are brought, from 1 to 1000.
    window : int
        Frames of a window, from 2.
    stride : int
        Frames from one window of a training clip to the next, from 1. Windows that are
        embedded for scores do not overlap.

    Raises
    ------
    InputError
        If a number is out of its range.
    """

    frame_rate: float
    window: int
    stride: int

    def __post_init__(self) -> None:
        check_frame_rate(self.frame_rate)
        self._check("window", 2 <= self.window <= LARGEST, f"2 to {LARGEST} frames")
        self._check("stride", 1 <= self.stride <= LARGEST, f"1 to {LARGEST} frames")

    @property
    def seconds(self) -> float:
        """Length of a window."""
        return self.window / self.frame_rate

    def _check(self, name: str, fits: bool, wanted: str) -> None:
        """Raise where the number called `name` does not fit."""
        if not fits:
            raise InputError(
                f"{name} of the network is {getattr(self, name)!r}", remedy=f"Give {wanted}"
            )
