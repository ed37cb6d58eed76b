"""How fast the corpus' wrists move, beside a minute of one of BEAT's speakers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

FRAME_RATE: Final = 15.0
"""At which it is measured, as BEAT's networks see motion."""


@dataclass(frozen=True, kw_only=True)
class Pace:
    """One quantity of the wrists, over all frames and both wrists.

    Attributes
    ----------
    quantity : str
        What it is, and its unit.
    mean, median, high : float
        The last is the 95th percentile.
    """

    quantity: str
    mean: float
    median: float
    high: float


BEAT: Final = (
    Pace(quantity="speed, m/s", mean=0.53, median=0.41, high=1.4),
    Pace(quantity="acceleration, m/s²", mean=3.6, median=3.0, high=8.7),
)
"""The same of a minute of BEAT's speaker 2 (take 2_scott_0_1_1), on the same figure."""


def paces(wrists: Iterable[FloatArray]) -> tuple[Pace, Pace]:
    """Return speed and acceleration of wrists.

    Parameters
    ----------
    wrists : iterable of ndarray, shape (T, 2, 3)
        Positions in metres in takes of at least two frames, at `FRAME_RATE`.
    """
    speeds, accelerations = [], []
    for positions in wrists:
        velocity = np.gradient(positions, axis=0) * FRAME_RATE
        speeds.append(np.linalg.norm(velocity, axis=2).ravel())
        change = np.gradient(velocity, axis=0) * FRAME_RATE
        accelerations.append(np.linalg.norm(change, axis=2).ravel())
    return _pace("speed, m/s", speeds), _pace("acceleration, m/s²", accelerations)


def _pace(quantity: str, values: list[FloatArray]) -> Pace:
    all_of_them = np.concatenate(values)
    return Pace(
        quantity=quantity,
        mean=float(all_of_them.mean()),
        median=float(np.median(all_of_them)),
        high=float(np.percentile(all_of_them, 95)),
    )
