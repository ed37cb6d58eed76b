"""Speech as AST and AMUSE read it: logarithms of Kaldi's mel bands, one row each 10 ms.

Gong et al. 2021; frames of 25 ms in a Hann window, standardised by the mean and the deviation that
AMUSE's release states.
"""

from __future__ import annotations

import warnings
from functools import cache
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from transformers import ASTFeatureExtractor

from motion.audio import SPEECH_RATE
from motion.errors import InputError

ROWS_PER_SECOND: Final = 100

SHORTEST: Final = 0.5
"""Seconds of speech below which nobody can be told apart."""

SILENCE: Final = 1e-4
"""Largest amplitude up to which a recording is silent; 80 dB below the loudest."""

_MEAN: Final = -9.173025
_DEVIATION: Final = 5.062332


def check_speech(samples: NDArray[np.float32]) -> None:
    """Raise `InputError` where speech at 16 kHz is shorter than half a second, or silent."""
    if len(samples) < SHORTEST * SPEECH_RATE:
        raise InputError(
            f"the recording lasts {len(samples) / SPEECH_RATE:.2f} s, too short to hear an emotion",
            remedy=f"Give at least {SHORTEST:g} s of speech",
        )
    if np.abs(samples).max() <= SILENCE:
        raise InputError(
            "the recording is silent", remedy="Give speech, or cut the silence from the excerpt"
        )


def filterbank(samples: NDArray[np.float32], rows: int = 1024, bands: int = 128) -> Tensor:
    """Return the standardised filterbank of speech.

    Parameters
    ----------
    samples : ndarray, shape (n,)
        Mono, at 16 kHz.
    rows : int
        How many rows it has: what is longer is cut, what is shorter is filled with zeros before
        it is standardised, as in the release.
    bands : int
        Mel bands.

    Returns
    -------
    Tensor
        (rows, bands).
    """
    extractor = _extractor(rows, bands)
    heard = extractor(samples, sampling_rate=SPEECH_RATE, return_tensors="np")
    return torch.as_tensor(np.asarray(heard["input_values"])[0], dtype=torch.float32)


@cache
def _extractor(rows: int, bands: int) -> ASTFeatureExtractor:
    with warnings.catch_warnings():
        # Kaldi's lowest bands are narrower than the spectrum is fine; they hold nothing there too.
        warnings.filterwarnings("ignore", message="At least one mel filter has all zero values")
        return ASTFeatureExtractor(
            sampling_rate=SPEECH_RATE,
            num_mel_bins=bands,
            max_length=rows,
            mean=_MEAN,
            std=_DEVIATION,
        )
