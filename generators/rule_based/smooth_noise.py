"""Slow, smooth, never repeating drift: what keeps a standing body from being a statue."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

_WAVES: Final = 7


def smooth_noise(
    times: NDArray[np.float64],
    channels: int,
    lowest: float,
    highest: float,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Return independent band-limited noise of unit root mean square.

    Parameters
    ----------
    times : ndarray, shape (T,)
        Seconds.
    channels : int
        How many independent signals.
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
