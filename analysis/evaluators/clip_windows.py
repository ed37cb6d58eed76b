"""The windows in which a network sees motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.clip import check_frame_rate
from motion.errors import InputError

FloatArray = NDArray[np.float32]

LARGEST: Final = 10_000
"""Of any size of a network; a file that asks for more is damaged."""

TOLERANCE: Final = 0.1
"""Seconds by which a clip may fall short of one window; its last frame is held as long."""


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


def window_starts(frames: int, window: int, stride: int) -> NDArray[np.int64]:
    """Return where the whole windows of a clip begin, every `stride` frames from its first."""
    return np.arange(0, frames - window + 1, stride, dtype=np.int64)


def long_enough(frames: FloatArray, window: int, frame_rate: float) -> FloatArray:
    """Return a clip's frames, shape (T, C), with at least `window` of them.

    Raises
    ------
    InputError
        If the clip is shorter by more than `TOLERANCE`.
    """
    missing = window - len(frames)
    if missing <= 0:
        return frames
    if missing > TOLERANCE * frame_rate + 1e-6:
        raise InputError(
            f"the clip lasts {len(frames) / frame_rate:.2f} s and the network looks at windows of "
            f"{window / frame_rate:.2f} s",
            remedy="Use longer clips, or a network of shorter windows (--config tiny has them)",
        )
    return np.concatenate([frames, np.repeat(frames[-1:], missing, axis=0)])


def windows(frames: FloatArray, window: int, stride: int) -> FloatArray:
    """Return the windows of a clip's frames, shape (T, C), as shape (n, window, C)."""
    starts = window_starts(len(frames), window, stride)
    return np.asarray(frames[starts[:, None] + np.arange(window)])
