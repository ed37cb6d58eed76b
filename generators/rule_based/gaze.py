"""Where the eyes look and when they blink."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.rule_based.minimum_jerk import Movement, follow, minimum_jerk

FloatArray = NDArray[np.float64]

_SIDEWAYS: Final = 32.0
_UP_AND_DOWN: Final = 25.0
_SACCADE: Final = 0.07
_FIXATION: Final = (0.5, 2.2)
_ON_VIEWER: Final = 0.65
_CLOSING: Final = 0.09
_OPENING: Final = 0.16


def gaze(
    head_in_world: FloatArray, looks_away: float, times: FloatArray, rng: np.random.Generator
) -> dict[str, FloatArray]:
    """Return the weights of the eyes' actions, each of shape (T,).

    The eyes rest on the viewer or on something beside, jump between the two (saccades), and
    make up for the head's own turning (the vestibulo-ocular reflex).

    Parameters
    ----------
    head_in_world : ndarray, shape (T, 3)
        Turn of the head in degrees: forward, to its left, to its right shoulder.
    looks_away : float
        Degrees, root mean square, between the viewer and what else is looked at.
    times : ndarray, shape (T,)
        Seconds.
    rng : numpy.random.Generator
    """
    jumps: list[Movement] = []
    moment = rng.uniform(*_FIXATION)
    while moment < times[-1]:
        aside = rng.normal(0, looks_away, 2) * (1.0, 0.5)
        target = np.zeros(2) if rng.random() < _ON_VIEWER else aside
        jumps.append(Movement(start=moment, end=moment + _SACCADE, target=target))
        moment += rng.uniform(*_FIXATION)
    wanted = follow(np.zeros(2), jumps, times)
    left = wanted[:, 0] - head_in_world[:, 1]
    down = wanted[:, 1] - head_in_world[:, 0]
    to_left, to_right = np.maximum(left, 0) / _SIDEWAYS, np.maximum(-left, 0) / _SIDEWAYS
    return {
        "eyeLookOutLeft": to_left,
        "eyeLookInRight": to_left,
        "eyeLookInLeft": to_right,
        "eyeLookOutRight": to_right,
        "eyeLookDown": np.maximum(down, 0) / _UP_AND_DOWN,
        "eyeLookUp": np.maximum(-down, 0) / _UP_AND_DOWN,
    }


def blinks(per_minute: float, times: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return how far the lids are shut at each time, shape (T,), in [0, 1].

    Parameters
    ----------
    per_minute : float
        Blinks a minute on average.
    times : ndarray, shape (T,)
        Seconds.
    rng : numpy.random.Generator
    """
    shut = np.zeros(len(times))
    # Blinks keep some distance from each other: gamma intervals, shape 3, not Poisson's.
    average = 60 / per_minute
    moment = rng.uniform(0.2, average)
    while moment < times[-1]:
        closing = minimum_jerk((times - moment) / _CLOSING)
        opening = minimum_jerk((times - moment - _CLOSING) / _OPENING)
        shut = np.maximum(shut, closing - opening)
        moment += max(rng.gamma(3.0, average / 3.0), 0.4)
    return shut
