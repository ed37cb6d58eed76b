"""The moments that a figure shows, and the words spoken at them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import find_peaks

from motion.audio import Audio
from motion.errors import InputError

MOST_MOMENTS: Final = 16
"""As many as are told apart in one figure."""

_STEP: Final = 0.01
_SYLLABLE: Final = 0.06
"""Seconds over which loudness is averaged, about half a syllable."""


@dataclass(frozen=True, kw_only=True)
class Moment:
    """One moment of a segment.

    Attributes
    ----------
    seconds : float
        From the segment's start.
    word : str
        The key word spoken there; empty where none was given.
    """

    seconds: float
    word: str = ""

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read ``2.4``, or ``word=2.4`` with the key word spoken there."""
        word, _, number = text.rpartition("=")
        try:
            return cls(seconds=float(number), word=word.strip())
        except ValueError:
            raise InputError(
                f"{text!r} is not a moment", remedy="Give seconds such as 2.4, or 'word=2.4'"
            ) from None

    @property
    def label(self) -> str:
        """The key word, or the time where there is none."""
        return self.word or f"{self.seconds:.1f} s"


def even_moments(duration: float, count: int) -> tuple[Moment, ...]:
    """Return `count` moments spread evenly over `duration` seconds, away from both ends."""
    return tuple(
        Moment(seconds=round(duration * (place + 0.5) / count, 3)) for place in range(count)
    )


def loud_moments(speech: Audio, count: int) -> tuple[Moment, ...]:
    """Return the loudest syllable in each of `count` equal parts of `speech`, in order.

    Gestures fall on stressed syllables, and those are loud; one for each part keeps the whole
    speech in view. They lie at least half a part from each other, so that no syllable is shown
    twice; a part without one gives its middle.
    """
    step = max(1, round(_STEP * speech.sample_rate))
    whole = len(speech.samples) // step * step
    if whole < count * step:
        return even_moments(speech.duration, count)
    energy = np.square(speech.samples[:whole], dtype=np.float64).reshape(-1, step).mean(axis=1)
    loudness = gaussian_filter1d(energy, _SYLLABLE / _STEP)
    syllables, _ = find_peaks(loudness, distance=math.ceil(len(loudness) / count / 2))
    moments = []
    for part in np.array_split(np.arange(len(loudness)), count):
        within = syllables[(syllables >= part[0]) & (syllables <= part[-1])]
        loudest = within[np.argmax(loudness[within])] if len(within) else part[len(part) // 2]
        moments.append(Moment(seconds=round(float(loudest) * _STEP, 3)))
    return tuple(moments)
