"""Which counts a printed percentage can stand for."""

from __future__ import annotations

import math
from typing import Final

_ROUNDING: Final = 1e-9
"""A share in the very middle of two printed ones may have been rounded either way."""


def counts_behind(percent: float, total: int, decimals: int = 0) -> range:
    """Return every count out of `total` that is printed as `percent`.

    Parameters
    ----------
    percent : float
        As printed, 0 to 100.
    total : int
        What it is a percentage of, at least 1.
    decimals : int
        Digits printed after the point.

    Returns
    -------
    range
        Empty where no count gives that percentage: it is impossible.
    """
    half = 0.5 * 10.0**-decimals + _ROUNDING
    low = max(math.ceil((percent - half) * total / 100), 0)
    high = min(math.floor((percent + half) * total / 100), total)
    return range(low, high + 1)


def printable_neighbours(percent: float, total: int, decimals: int = 0) -> tuple[float, float]:
    """Return the percentages of `total` next below and next above `percent`, as printed."""
    below = math.floor(percent * total / 100)
    low, high = (round(100 * count / total, decimals) for count in (below, below + 1))
    return low, high
