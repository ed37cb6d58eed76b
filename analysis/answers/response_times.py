"""How long participants take, and who answers faster than one can have looked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Floats = NDArray[np.float64]

RELATIVE_SPEED: Final = 2.0
"""Times as fast as the typical participant from which one is too fast (Leiner 2019)."""


@dataclass(frozen=True, kw_only=True)
class ParticipantTime:
    """How long one participant takes for an answer.

    Attributes
    ----------
    participant : str
        Who.
    median : float
        In seconds.
    answers : int
        How many times are known.
    too_fast_share : float
        Share of the answers that were faster than the limit, in [0, 1].
    too_fast : bool
        Whether the median is below the limit.
    """

    participant: str
    median: float
    answers: int
    too_fast_share: float
    too_fast: bool


@dataclass(frozen=True, kw_only=True)
class ResponseTimes:
    """How long answers took.

    Attributes
    ----------
    median : float
        Median of the participants' medians, in seconds; NaN without times.
    quartiles : (float, float)
        Of the participants' medians.
    limit : float
        Seconds below which an answer is too fast.
    participants : tuple of ParticipantTime
        In the order of appearance; those without any time are left out.
    answers, missing : int
        Answers with a time, and without.
    method : str
        Where the limit comes from; empty without times.
    reason : str
        Why there are no numbers; empty where there are.
    """

    median: float
    quartiles: tuple[float, float]
    limit: float
    participants: tuple[ParticipantTime, ...]
    answers: int
    missing: int
    method: str = ""
    reason: str = ""

    @property
    def too_fast(self) -> tuple[str, ...]:
        """Participants whose median is below the limit."""
        return tuple(person.participant for person in self.participants if person.too_fast)


def response_times(
    seconds: Floats, participants: NDArray[np.generic], *, limit: float | None = None
) -> ResponseTimes:
    """Summarise response times; nobody is excluded by them.

    Parameters
    ----------
    seconds : ndarray, shape (N,)
        Time of each answer; NaN where it is not known.
    participants : ndarray, shape (N,)
        Who answered.
    limit : float, optional
        Seconds below which an answer is too fast, such as a video's length. Without it, half the
        typical participant's median.
    """
    times = pd.DataFrame({"participant": participants, "seconds": seconds})
    known = times[np.isfinite(times["seconds"])]
    missing = len(times) - len(known)
    if known.empty:
        return ResponseTimes(
            median=math.nan,
            quartiles=(math.nan, math.nan),
            limit=math.nan if limit is None else limit,
            participants=(),
            answers=0,
            missing=missing,
            reason="no response times",
        )
    groups = known.groupby("participant", sort=False, observed=True)["seconds"]
    medians = groups.median()
    low, middle, high = np.quantile(medians.to_numpy(np.float64), [0.25, 0.5, 0.75]).tolist()
    bound = middle / RELATIVE_SPEED if limit is None else limit
    counts = groups.size()
    hasty = (
        (known["seconds"] < bound).groupby(known["participant"], sort=False, observed=True).mean()
    )
    return ResponseTimes(
        median=middle,
        quartiles=(low, high),
        limit=bound,
        participants=tuple(
            ParticipantTime(
                participant=str(name),
                median=float(medians[name]),
                answers=int(counts[name]),
                too_fast_share=float(hasty[name]),
                too_fast=bool(medians[name] < bound),
            )
            for name in medians.index
        ),
        answers=len(known),
        missing=missing,
        method="limit stated" if limit is not None else "limit at half the median participant's",
    )
