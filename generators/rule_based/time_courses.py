"""Courses over time: how a hand gets from one place to the next, and how what rests drifts.

A hand that reaches moves along the course with the least jerk (Flash & Hogan 1985, eq. 3), and
a movement that begins before the last one has ended adds to it (Flash & Henis 1991,
superposition). So a preparation flows into its stroke without a stop between them. Slow drift that
never repeats keeps a standing body from being a statue.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.prosody import Prosody

FloatArray = NDArray[np.float64]

_WAVES: Final = 7


@dataclass(frozen=True, kw_only=True, eq=False)
class Movement:
    """One movement to a target.

    Attributes
    ----------
    start, end : float
        Seconds, ``start < end``.
    target : ndarray, shape (C,)
        Where it goes, in any channels.
    bow : ndarray, shape (C,) or None
        How far the course bends off the straight line half-way; None for a straight one.
    """

    start: float
    end: float
    target: FloatArray
    bow: FloatArray | None = None


def minimum_jerk(progress: FloatArray) -> FloatArray:
    """Return the share of the way covered at each share of the time; both in [0, 1].

    Parameters
    ----------
    progress : ndarray
        Elapsed share of the movement's time; values outside [0, 1] are held at the ends.

    Returns
    -------
    ndarray
        ``10 s^3 - 15 s^4 + 6 s^5``: speed and acceleration are zero at both ends.
    """
    s = np.clip(progress, 0.0, 1.0)
    return np.asarray(s**3 * (10 - 15 * s + 6 * s**2))


def swell(progress: FloatArray) -> FloatArray:
    """Return a smooth hump over [0, 1]: 0 with no speed at both ends, 1 half-way."""
    s = np.clip(progress, 0.0, 1.0)
    return np.asarray(64 * (s * (1 - s)) ** 3)


def follow(start: FloatArray, movements: Iterable[Movement], times: FloatArray) -> FloatArray:
    """Return the values at `times` of successive movements from `start`.

    Parameters
    ----------
    start : ndarray, shape (C,)
        The values before the first movement.
    movements : iterable of Movement
        In the order in which they begin; overlapping ones add up.
    times : ndarray, shape (T,)
        Seconds.

    Returns
    -------
    ndarray, shape (T, C)
    """
    course = np.tile(np.asarray(start, float), (len(times), 1))
    place = np.asarray(start, float)
    for movement in movements:
        progress = (times - movement.start) / (movement.end - movement.start)
        course += minimum_jerk(progress)[:, None] * (movement.target - place)
        if movement.bow is not None:
            course += swell(progress)[:, None] * movement.bow
        place = movement.target
    return course


def pulse(times: FloatArray, peak: float, rise: float, fall: float) -> FloatArray:
    """Return a movement that goes out and comes back: 0, up to 1 at `peak`, back to 0.

    Parameters
    ----------
    times : ndarray, shape (T,)
        Seconds.
    peak : float
        When it is 1.
    rise, fall : float
        Seconds from 0 to the peak and from the peak back to 0.
    """
    up = minimum_jerk((times - (peak - rise)) / rise)
    down = minimum_jerk((times - peak) / fall)
    return up - down


def on_accents(
    prosody: Prosody, times: FloatArray, *, rise: float, fall: float, lead: float = 0.0
) -> FloatArray:
    """Return pulses as high as the accents are prominent, which peak `lead` seconds before them."""
    beats = np.zeros(len(times))
    for accent, strength in zip(prosody.accents, prosody.prominence, strict=True):
        beats = np.maximum(beats, strength * pulse(times, accent - lead, rise, fall))
    return beats


def smooth_noise(
    times: FloatArray, channels: int, lowest: float, highest: float, rng: np.random.Generator
) -> FloatArray:
    """Return independent band-limited noise of unit root mean square.

    Parameters
    ----------
    times : ndarray, shape (T,)
        Seconds.
    channels : int
        The number of independent signals.
    lowest, highest : float
        The band in Hz; slower waves are stronger, as in a standing body's sway (amplitude
        falls with the root of the frequency).
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (T, channels)
    """
    edges = np.geomspace(lowest, highest, _WAVES + 1)
    frequency = rng.uniform(edges[:-1], edges[1:], size=(channels, _WAVES))
    phase = rng.uniform(0, 2 * np.pi, size=(channels, _WAVES))
    strength = frequency**-0.5
    strength *= np.sqrt(2 / (strength**2).sum(axis=1, keepdims=True))
    waves = np.sin(2 * np.pi * frequency * times[:, None, None] + phase)
    return np.asarray((strength * waves).sum(axis=2))
