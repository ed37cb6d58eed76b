"""How loud the speech is in each band of pitch, a row for each frame of motion."""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.audio import Audio
from motion.errors import InputError
from motion.speech.audio_analysis import load_librosa

FloatArray = NDArray[np.float32]

RATE: Final = 18_000
"""Samples per second of the sound that is analysed."""

BANDS: Final = 128
WINDOW: Final = 2048
"""Samples that a frame looks at, in the middle of which it lies; before and after the speech is
silence."""

REACH: Final = 0.06
"""Seconds on either side of a frame outside of which no sound changes it: half a window, and what
resampling looks at."""


def mel_bands(audio: Audio, frame_rate: float, frames: int | None = None) -> FloatArray:
    """Return the power of `audio` in 128 mel bands.

    As DiffSHEG's released network reads it: 18 kHz, a Hann window of 2048 samples, bands of equal
    area on Slaney's mel scale up to 9 kHz, power and not its logarithm.

    Parameters
    ----------
    audio : Audio
        At any rate; it is resampled.
    frame_rate : float
        Frames per second of the motion, so that a frame lasts whole samples: 15 or 30.
    frames : int, optional
        Rows wanted, by default as many as the speech lasts.

    Returns
    -------
    ndarray, shape (frames, 128)
        Row k belongs to ``k / frame_rate`` seconds.

    Raises
    ------
    InputError
        If a frame does not last whole samples.
    """
    hop = _hop(frame_rate)
    count = round(audio.duration * frame_rate) if frames is None else frames
    sound = audio.samples_at(RATE)
    padded = np.zeros(max(count - 1, 0) * hop + WINDOW)
    within = sound[: len(padded) - WINDOW // 2]
    padded[WINDOW // 2 : WINDOW // 2 + len(within)] = within
    windows = np.lib.stride_tricks.sliding_window_view(padded, WINDOW)[::hop][:count]
    # As long as the window is periodic, not symmetric: that is what analysis of sound means by it.
    hann = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(WINDOW) / WINDOW)
    power = np.abs(np.fft.rfft(windows * hann, axis=1)) ** 2
    return np.asarray(power @ _filters().T, dtype=np.float32)


def _hop(frame_rate: float) -> int:
    if not frame_rate > 0 or RATE % frame_rate:
        raise InputError(
            f"mel bands cannot be had at {frame_rate:g} frames per second",
            remedy=f"Use a frame rate that divides {RATE}, such as 15 or 30",
        )
    return int(RATE // frame_rate)


@cache
def _filters() -> NDArray[np.float64]:
    """Return what each band takes of each frequency, (128, 1025)."""
    librosa = load_librosa()
    filters = librosa.filters.mel(sr=RATE, n_fft=WINDOW, n_mels=BANDS, dtype=np.float64)
    return np.asarray(filters)
