"""Where in speech the speakers of the corpus gesture, and how a stroke goes.

A stroke arrives where the voice rises fastest towards a loud syllable: a peak of the loudness of at
least 0.35 that stands out by 0.1, and louder than every other within the emotion's spacing. Its
size is how far the loudness of that peak exceeds 0.35, times 1.6: about 1 for a loud syllable.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

from training.corpus.heard_speech import STEPS_PER_SECOND, HeardSpeech

FloatArray = NDArray[np.float64]

LOUD_ENOUGH: Final = 0.35
STANDS_OUT: Final = 0.1
_SIZE: Final = 1.6
_RISE: Final = 0.2
"""Seconds before the peak in which the voice rises to it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Strokes:
    """Strokes in order of time.

    Attributes
    ----------
    times : ndarray, shape (N,)
        Seconds at which they arrive.
    sizes : ndarray, shape (N,)
        At least 0; about 1 for a loud syllable.
    """

    times: FloatArray
    sizes: FloatArray


def find_strokes(heard: HeardSpeech, spacing: float) -> Strokes:
    """Return the strokes that speech calls for, at least about `spacing` seconds apart."""
    loudness = heard.loudness
    peaks, _ = find_peaks(
        loudness,
        height=LOUD_ENOUGH,
        prominence=STANDS_OUT,
        distance=max(1, round(spacing * STEPS_PER_SECOND)),
    )
    slope = np.gradient(loudness)
    before = round(_RISE * STEPS_PER_SECOND)
    starts = np.maximum(peaks - before, 0)
    arrivals = [
        start + int(np.argmax(slope[start : peak + 1]))
        for start, peak in zip(starts, peaks, strict=True)
    ]
    return Strokes(
        times=np.array(arrivals, np.float64) / STEPS_PER_SECOND,
        sizes=_SIZE * (loudness[peaks] - LOUD_ENOUGH),
    )


def stroke_shape(since: FloatArray, attack: float, release: float) -> FloatArray:
    """Return how far out a stroke of size 1 is, in [0, 1].

    Parameters
    ----------
    since : ndarray
        Seconds since its arrival; negative before.
    attack, release : float
        Seconds in which it goes out and comes back, above 0. Both ways are movements of minimum
        jerk (Flash & Hogan 1985) from rest to rest, so that the hand stands still on arrival.
    """
    out = np.clip(1 + since / attack, 0, 1)
    back = np.clip(1 - since / release, 0, 1)
    share = np.where(since < 0, out, back)
    return np.asarray(share**3 * (10 - 15 * share + 6 * share**2))
