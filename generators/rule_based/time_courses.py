"""Courses over time: movements of a hand from one place to the next, and drift at rest.

A reaching hand follows the course of minimum jerk (Flash & Hogan 1985, eq. 3). A movement that
starts before the previous one has ended is superposed on it (Flash & Henis 1991), so that a
preparation flows into its stroke without a stop. Slow drift that never repeats keeps a standing
body from looking like a statue.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion.arrays import Floats
from motion.prosody import Prosody

_WAVES: Final = 7


@dataclass(frozen=True, kw_only=True, eq=False)
class Movement:
    """One movement to a target.

    Attributes
    ----------
    start, end : float
        Seconds, ``start < end``.
    target : ndarray, shape (C,)
        Values at its end, in any channels.
    bow : ndarray, shape (C,) or None
        Deviation of the course from the straight line halfway; None for a straight course.
    """

    start: float
    end: float
    target: Floats
    bow: Floats | None = None


def minimum_jerk(progress: Floats) -> Floats:
    """Return the covered share of the way at each share of the time; both in [0, 1].

    Parameters
    ----------
    progress : ndarray
        Elapsed share of the movement's time; clipped to [0, 1].

    Returns
    -------
    ndarray
        ``10 s^3 - 15 s^4 + 6 s^5``: speed and acceleration are zero at both ends.
    """
    s = np.clip(progress, 0.0, 1.0)
    return np.asarray(s**3 * (10 - 15 * s + 6 * s**2))


def swell(progress: Floats) -> Floats:
    """Return a smooth hump over [0, 1]: 0 with zero speed at both ends, 1 halfway."""
    s = np.clip(progress, 0.0, 1.0)
    return np.asarray(64 * (s * (1 - s)) ** 3)


def follow(start: Floats, movements: Iterable[Movement], times: Floats) -> Floats:
    """Return the values at `times` of successive movements from `start`.

    Parameters
    ----------
    start : ndarray, shape (C,)
        The values before the first movement.
    movements : iterable of Movement
        Movements in order of their starts; overlapping ones add up.
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


def pulse(times: Floats, peak: float, rise: float, fall: float) -> Floats:
    """Return a movement that goes out and comes back: from 0 to 1 at `peak`, and back to 0.

    Parameters
    ----------
    times : ndarray, shape (T,)
        Seconds.
    peak : float
        Time of the peak.
    rise, fall : float
        Seconds from 0 to the peak and from the peak back to 0.
    """
    up = minimum_jerk((times - (peak - rise)) / rise)
    down = minimum_jerk((times - peak) / fall)
    return up - down


def on_accents(
    prosody: Prosody, times: Floats, *, rise: float, fall: float, lead: float = 0.0
) -> Floats:
    """Return pulses that peak `lead` seconds before the accents, as high as their prominence."""
    beats = np.zeros(len(times))
    for accent, strength in zip(prosody.accents, prosody.prominence, strict=True):
        beats = np.maximum(beats, strength * pulse(times, accent - lead, rise, fall))
    return beats


def smooth_noise(
    times: Floats, channels: int, lowest: float, highest: float, rng: np.random.Generator
) -> Floats:
    """Return independent band-limited noise of unit root mean square.

    Parameters
    ----------
    times : ndarray, shape (T,)
        Seconds.
    channels : int
        The number of independent signals.
    lowest, highest : float
        The band in Hz; slower waves are stronger, as in a standing body's sway (the amplitude is
        proportional to the inverse square root of the frequency).
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
