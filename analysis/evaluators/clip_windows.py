"""Cutting clips into the windows that networks look at."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

FloatArray = NDArray[np.float32]

TOLERANCE: Final = 0.1
"""Seconds by which a clip may fall short of one window; its last frame is held as long."""


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
