"""How long participants take, and who answers faster than one can have looked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Floats = NDArray[np.float64]

RELATIVE_SPEED: Final = 2.0
"""Times as fast as the typical participant from which one is too fast (Leiner 2019)."""


@dataclass(frozen=True, kw_only=True)
class ResponseTimes:
    """How long answers took.

    Attributes
    ----------
    median, low_quartile, high_quartile : float
        Of the participants' medians, in seconds; NaN without times.
    limit : float
        Half the median: a participant whose median is below it is too fast.
    too_fast : mapping of participant to float
        The medians of those who are.
    n, missing : int
        Answers whose time is known, and is not.
    reason : str
        Why there are no numbers; empty where there are.
    """

    median: float = math.nan
    low_quartile: float = math.nan
    high_quartile: float = math.nan
    limit: float = math.nan
    too_fast: Mapping[str, float]
    n: int
    missing: int
    reason: str = ""


def response_times(seconds: Floats, participants: Sequence[str] | pd.Categorical) -> ResponseTimes:
    """Summarise response times; nobody is excluded by them.

    Parameters
    ----------
    seconds : ndarray, shape (N,)
        Time of each answer; NaN where it is not known.
    participants : sequence of str, shape (N,)
        Who answered.
    """
    times = pd.Series(np.asarray(seconds, np.float64))
    known = times[np.isfinite(times)]
    missing = len(times) - len(known)
    if known.empty:
        return ResponseTimes(too_fast={}, n=0, missing=missing, reason="no response times")
    who = pd.Series(participants)[known.index]
    medians = known.groupby(who, sort=False, observed=True).median()
    low, middle, high = np.quantile(medians.to_numpy(np.float64), [0.25, 0.5, 0.75]).tolist()
    limit = middle / RELATIVE_SPEED
    return ResponseTimes(
        median=middle,
        low_quartile=low,
        high_quartile=high,
        limit=limit,
        too_fast={str(name): float(own) for name, own in medians.items() if own < limit},
        n=len(known),
        missing=missing,
    )
