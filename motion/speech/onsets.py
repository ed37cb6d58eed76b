"""Onsets of speech: the audio beats that beat alignment compares a motion with.

They come from spectral flux and share nothing with the accents of `motion.speech.prosody`, to which
a rule-based generator ties its gestures: a score must not measure a generator with its own ruler.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.audio import Audio
from motion.speech.audio_analysis import load_librosa

DETECTOR: Final = "librosa 0.11 spectral-flux onsets, 16 kHz, 10 ms hop"
"""What `speech_onsets` runs, in words for a footnote."""

_RATE: Final = 16000
_HOP: Final = 160
_SILENCE: Final = 1e-4


def speech_onsets(audio: Audio) -> NDArray[np.float64]:
    """Return when sounds begin in `audio`.

    Parameters
    ----------
    audio : Audio
        Speech, mono.

    Returns
    -------
    ndarray, shape (N,)
        Onset times in seconds, ascending; empty for silence.

    Notes
    -----
    Onset strength is spectral flux over 128 mel bands (Böck & Widmer 2013), picked by librosa's
    own defaults, as in BEAT's evaluation (Liu et al. 2022) but at a finer hop.
    """
    samples = np.asarray(audio.samples, np.float32)
    if float(np.max(np.abs(samples), initial=0.0)) < _SILENCE:
        return np.zeros(0)
    librosa = load_librosa()
    if audio.sample_rate != _RATE:
        samples = librosa.resample(samples, orig_sr=audio.sample_rate, target_sr=_RATE)
    onsets = librosa.onset.onset_detect(y=samples, sr=_RATE, hop_length=_HOP, units="time")
    return np.asarray(onsets, np.float64)
