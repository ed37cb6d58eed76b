"""Random variation of a take that does not depend on speech, emotion or speaker.

Definitions
-----------
strokes
    One in ten is omitted. The sizes of the others are multiplied by a lognormal number (mean 1,
    sigma 0.3), and their arrivals are shifted by a normal number (30 ms). The hands are drawn for
    four strokes at a time: the leading hand (0.5), both (0.35) or the other hand (0.15).
drift
    A sum of six cosines of random phase and log-uniform frequency between 0.06 and 0.6 Hz; mean 0,
    variance 1.
blinks
    A Poisson process, one per four seconds on average.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from motion.arrays import Floats

OMITTED_SHARE: Final = 0.1
_SIZE_SIGMA: Final = 0.3
_DELAY: Final = 0.03
_STROKES_AT_A_TIME: Final = 4
_HANDS: Final = ((1.0, 0.15), (0.8, 0.8), (0.15, 1.0))
"""Factors on a stroke of the leading and the other hand, in each case."""
_HAND_PROBABILITIES: Final = (0.5, 0.35, 0.15)
_COSINES: Final = 6
_LOWEST, _HIGHEST = 0.06, 0.6
_BLINKS_PER_SECOND: Final = 0.25

_STROKES, _DRIFT, _BLINKS = 1, 2, 3


@dataclass(frozen=True, kw_only=True, eq=False)
class StrokeChance:
    """Random variation of strokes.

    Attributes
    ----------
    gains : ndarray, shape (N, 2)
        Factors on the size, of the leading and of the other hand.
    delays : ndarray, shape (N,)
        Delays of the arrivals in seconds.
    """

    gains: Floats
    delays: Floats


@dataclass(frozen=True, kw_only=True)
class Chance:
    """The random numbers of one take.

    Attributes
    ----------
    seed : tuple of int, or None
        Seed of the random generator; None for expected values.
    """

    seed: tuple[int, ...] | None

    def strokes(self, count: int) -> StrokeChance:
        """Return the random variation of `count` strokes."""
        hands = np.array(_HANDS)
        if self.seed is None:
            expected = (1 - OMITTED_SHARE) * (np.array(_HAND_PROBABILITIES) @ hands)
            return StrokeChance(gains=np.tile(expected, (count, 1)), delays=np.zeros(count))
        random = np.random.default_rng([*self.seed, _STROKES])
        sizes = np.exp(random.normal(-(_SIZE_SIGMA**2) / 2, _SIZE_SIGMA, count))
        performed = random.uniform(size=count) >= OMITTED_SHARE
        delays = random.normal(0, _DELAY, count)
        groups = -(-count // _STROKES_AT_A_TIME)
        choices = random.choice(len(hands), size=groups, p=_HAND_PROBABILITIES)
        hand_shares = hands[np.repeat(choices, _STROKES_AT_A_TIME)[:count]]
        return StrokeChance(gains=(sizes * performed)[:, None] * hand_shares, delays=delays)

    def drift(self, times: Floats, channels: int, stream: int) -> Floats:
        """Return slow drift of mean 0 and variance 1, shape (T, channels).

        Parameters
        ----------
        times : ndarray, shape (T,)
            Seconds.
        channels : int
            Number of curves.
        stream : int
            Distinguishes the curves of different callers.
        """
        if self.seed is None:
            return np.zeros((len(times), channels))
        random = np.random.default_rng([*self.seed, _DRIFT, stream])
        shape = (channels, _COSINES)
        frequencies = np.exp(random.uniform(np.log(_LOWEST), np.log(_HIGHEST), shape))
        phases = random.uniform(0, 2 * np.pi, shape)
        waves = np.cos(2 * np.pi * frequencies * times[:, None, None] + phases)
        return np.asarray(np.sqrt(2 / _COSINES) * waves.sum(axis=2))

    def blinks(self, duration: float) -> Floats:
        """Return the times of blinks within `duration` seconds, ascending."""
        if self.seed is None:
            return np.zeros(0)
        random = np.random.default_rng([*self.seed, _BLINKS])
        count = random.poisson(_BLINKS_PER_SECOND * duration)
        return np.sort(random.uniform(0, duration, count))


EXPECTED: Final = Chance(seed=None)
"""No randomness: everything has its mean value."""
