"""Whether a rendered video is what it should be, found by opening it."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import av

from motion.audio import read_audio
from motion.errors import InputError
from renderer.loudness import integrated_loudness

DURATION_TOLERANCE: Final = 0.1
"""Seconds by which a video may be longer or shorter than its segment."""


def flaw_of(video: Path, seconds: float, *, sound: bool = True) -> str | None:
    """Return what is wrong with a video that should last `seconds`; None where nothing is.

    Its index is read and its first frame decoded, not the whole of it.

    Parameters
    ----------
    video : Path
        Any file.
    seconds : float
        May be missed by `DURATION_TOLERANCE`.
    sound : bool
        Whether it must have sound.
    """
    try:
        with av.open(str(video)) as container:
            if not container.streams.video:
                return "has no picture"
            if sound and not container.streams.audio:
                return "has no sound"
            lasts = (container.duration or 0) / av.time_base
            if abs(lasts - seconds) > DURATION_TOLERANCE:
                return f"lasts {lasts:.2f} s, its segment {seconds:.2f} s"
            if next(container.decode(video=0), None) is None:
                return "has no frame"
    except (av.FFmpegError, OSError):
        return "cannot be played: it is damaged or no video"
    return None


def loudness_of(video: Path) -> float | None:
    """Return how loud a video is in LUFS; None where it is silent, too short or damaged."""
    try:
        return integrated_loudness(read_audio(video, sample_rate=None))
    except InputError:
        return None
