"""Spectra of speech: mel bands per frame of motion, their cepstrum, and AMUSE's filterbanks.

AST and AMUSE read Kaldi's log mel bands, one row per 10 ms (Gong et al. 2021): frames of 25 ms in a
Hann window, standardised by the mean and standard deviation of AMUSE's release.
"""

from __future__ import annotations

import warnings
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np
import torch
from scipy.fft import dct
from torch import Tensor

from motion.arrays import Floats, Floats32
from motion.audio import SPEECH_RATE, Audio
from motion.audio_analysis import load_librosa
from motion.errors import InputError

if TYPE_CHECKING:
    from transformers import ASTFeatureExtractor

ROWS_PER_SECOND: Final = 100

SHORTEST: Final = 0.5
"""Shortest speech in seconds from which speakers can be distinguished."""

SILENCE: Final = 1e-4
"""Largest amplitude of a silent recording; 80 dB below full scale."""

_MEAN: Final = -9.173025
_DEVIATION: Final = 5.062332


def check_speech(samples: Floats32) -> None:
    """Raise `InputError` if speech at 16 kHz is shorter than half a second, or silent."""
    if len(samples) < SHORTEST * SPEECH_RATE:
        raise InputError(
            f"the recording lasts {len(samples) / SPEECH_RATE:.2f} s, too short for an emotion",
            remedy=f"Give at least {SHORTEST:g} s of speech",
        )
    if np.abs(samples).max() <= SILENCE:
        raise InputError(
            "the recording is silent", remedy="Give speech, or cut the silence from the excerpt"
        )


def filterbank(samples: Floats32, rows: int = 1024, bands: int = 128) -> Tensor:
    """Return the standardised filterbank of speech.

    Parameters
    ----------
    samples : ndarray, shape (n,)
        Mono, at 16 kHz.
    rows : int
        Number of rows: longer filterbanks are cut, shorter ones padded with zeros before they are
        standardised, as in the release.
    bands : int
        Number of mel bands.

    Returns
    -------
    Tensor
        (rows, bands).
    """
    extractor = _feature_extractor(rows, bands)
    features = extractor(samples, sampling_rate=SPEECH_RATE, return_tensors="np")
    return torch.as_tensor(np.asarray(features["input_values"])[0], dtype=torch.float32)


@cache
def _feature_extractor(rows: int, bands: int) -> ASTFeatureExtractor:
    # Imported here: it takes a second, and few networks hear by filterbanks.
    from transformers import ASTFeatureExtractor

    with warnings.catch_warnings():
        # Kaldi's lowest bands are narrower than the spectrum's resolution, and empty in Kaldi too.
        warnings.filterwarnings("ignore", message="At least one mel filter has all zero values")
        return ASTFeatureExtractor(
            sampling_rate=SPEECH_RATE,
            num_mel_bins=bands,
            max_length=rows,
            mean=_MEAN,
            std=_DEVIATION,
        )


RATE: Final = 18_000
"""Sample rate of the analysed sound, in Hz."""

BANDS: Final = 128
WINDOW: Final = 2048
"""Samples of a frame's window, centred on the frame; the speech is padded with silence."""


def mel_bands(audio: Audio, frame_rate: float, frames: int | None = None) -> Floats32:
    """Return the power of `audio` in 128 mel bands.

    As for DiffSHEG's released network: 18 kHz, a Hann window of 2048 samples, bands of equal area
    on Slaney's mel scale up to 9 kHz, power and not its logarithm.

    Parameters
    ----------
    audio : Audio
        The speech at any rate; it is resampled.
    frame_rate : float
        Frames per second of the motion; a frame must last a whole number of samples, as at 15 or
        30.
    frames : int, optional
        Number of rows; by default that of the speech.

    Returns
    -------
    ndarray, shape (frames, 128)
        Row k is for ``k / frame_rate`` seconds.

    Raises
    ------
    InputError
        If a frame does not last a whole number of samples.
    """
    hop = _hop(frame_rate)
    count = round(audio.duration * frame_rate) if frames is None else frames
    sound = audio.samples_at(RATE)
    padded = np.zeros(max(count - 1, 0) * hop + WINDOW)
    inside = sound[: len(padded) - WINDOW // 2]
    padded[WINDOW // 2 : WINDOW // 2 + len(inside)] = inside
    windows = np.lib.stride_tricks.sliding_window_view(padded, WINDOW)[::hop][:count]
    # A periodic Hann window, as is usual in the analysis of sound, not a symmetric one.
    hann = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(WINDOW) / WINDOW)
    power = np.abs(np.fft.rfft(windows * hann, axis=1)) ** 2
    return np.asarray(power @ _filters().T, dtype=np.float32)


def _hop(frame_rate: float) -> int:
    if not frame_rate > 0 or RATE % frame_rate:
        raise InputError(
            f"mel bands cannot be computed at {frame_rate:g} frames per second",
            remedy=f"Use a frame rate that divides {RATE}, such as 15 or 30",
        )
    return int(RATE // frame_rate)


@cache
def _filters() -> Floats:
    """Return the weights of frequencies in each band, (128, 1025)."""
    librosa = load_librosa()
    filters = librosa.filters.mel(sr=RATE, n_fft=WINDOW, n_mels=BANDS, dtype=np.float64)
    return np.asarray(filters)


COEFFICIENTS: Final = 14
ROWS_PER_FRAME: Final = 2
"""Rows of coefficients per frame of motion."""

WIDTH: Final = ROWS_PER_FRAME * 3 * COEFFICIENTS
"""Channels of a frame: each row's coefficients and their first and second differences."""

_QUIETEST: Final = 1e-4
"""Power below which bands are silent."""


def mfcc(audio: Audio, frame_rate: float, frames: int | None = None) -> Floats32:
    """Return the mel-frequency cepstral coefficients of `audio`, (frames, 84).

    Parameters
    ----------
    audio : Audio
        The speech at any rate.
    frame_rate : float
        Frames per second of the motion; `mel_bands` must be able to compute twice as many.
    frames : int, optional
        Number of rows; by default that of the speech.
    """
    count = max(1, round(audio.duration * frame_rate)) if frames is None else frames
    bands = mel_bands(audio, ROWS_PER_FRAME * frame_rate, ROWS_PER_FRAME * count).astype(np.float64)
    rows = dct(np.log10(np.maximum(bands, _QUIETEST)), norm="ortho", axis=1)[:, :COEFFICIENTS]
    differences = np.gradient(rows, axis=0)
    coefficients = np.concatenate([rows, differences, np.gradient(differences, axis=0)], axis=1)
    return coefficients.reshape(count, WIDTH).astype(np.float32)


def log_mel(audio: Audio, frame_rate: float, frames: int | None = None) -> Floats32:
    """Return the spectrogram of `audio`: 128 log mel bands, (frames, 128)."""
    count = max(1, round(audio.duration * frame_rate)) if frames is None else frames
    return np.log10(np.maximum(mel_bands(audio, frame_rate, count), _QUIETEST))
