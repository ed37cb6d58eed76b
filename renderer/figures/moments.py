"""The moments that a figure shows, and the words spoken at them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from motion.audio import Audio
from motion.errors import InputError

_STEP = 0.01
_SYLLABLE = 0.06
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
                f"{text!r} is no moment", remedy="Give seconds such as 2.4, or 'word=2.4'"
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
    """Return the loudest moment in each of `count` equal parts of `speech`, in order.

    Gestures fall on stressed syllables, and those are loud; one for each part keeps the whole
    speech in view. A part without sound gives its middle.
    """
    step = max(1, round(_STEP * speech.sample_rate))
    whole = len(speech.samples) // step * step
    energy = np.square(speech.samples[:whole], dtype=np.float64).reshape(-1, step).mean(axis=1)
    loudness = gaussian_filter1d(energy, _SYLLABLE / _STEP)
    moments = []
    for part in np.array_split(np.arange(len(loudness)), count):
        if not len(part):
            return even_moments(speech.duration, count)
        moments.append(Moment(seconds=round(float(_loudest(loudness, part)) * _STEP, 3)))
    return tuple(moments)


def _loudest(loudness: NDArray[np.float64], part: NDArray[np.int_]) -> int:
    """Return the step of `part` with the greatest `loudness`, its middle in silence."""
    if loudness[part].max() <= 0:
        return int(part[len(part) // 2])
    return int(part[int(np.argmax(loudness[part]))])
