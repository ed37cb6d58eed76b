"""Mel-frequency cepstral coefficients: the colour of the speech, and how it changes."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from motion.audio import Audio
from training.hearing.mel import mel_bands

COEFFICIENTS: Final = 14
ROWS: Final = 2
"""Rows of coefficients in a frame of motion."""

WIDTH: Final = ROWS * 3 * COEFFICIENTS
"""Channels of a frame: of each row the coefficients, their first and their second differences."""

_QUIETEST: Final = 1e-4
"""Power below which bands are silent."""


def mfcc(audio: Audio, frame_rate: float, frames: int | None = None) -> NDArray[np.float32]:
    """Return the coefficients of `audio`, (frames, 84).

    Parameters
    ----------
    audio : Audio
        At any rate.
    frame_rate : float
        Frames per second of the motion; see `training.hearing.mel.mel_bands`, with twice as many.
    frames : int, optional
        By default as many as the speech lasts.
    """
    count = max(1, round(audio.duration * frame_rate)) if frames is None else frames
    bands = mel_bands(audio, ROWS * frame_rate, ROWS * count).astype(np.float64)
    rows = dct(np.log10(np.maximum(bands, _QUIETEST)), norm="ortho", axis=1)[:, :COEFFICIENTS]
    change = np.gradient(rows, axis=0)
    all_rows = np.concatenate([rows, change, np.gradient(change, axis=0)], axis=1)
    return all_rows.reshape(count, WIDTH).astype(np.float32)


def log_mel(audio: Audio, frame_rate: float, frames: int | None = None) -> NDArray[np.float32]:
    """Return the spectrogram of `audio`: logarithms of 128 mel bands, (frames, 128)."""
    count = max(1, round(audio.duration * frame_rate)) if frames is None else frames
    return np.log10(np.maximum(mel_bands(audio, frame_rate, count), _QUIETEST))
