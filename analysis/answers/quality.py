"""How answers were given: how fast, and how much alike; nobody is excluded by it."""

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

ALIKE: Final = 0.9
"""Share of one answer among all of a participant from which the participant is listed."""


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


@dataclass(frozen=True, kw_only=True)
class StraightLine:
    """How alike one participant's answers are.

    Attributes
    ----------
    participant : str
        Whose.
    answers : int
        How many were given.
    share : float
        Of the most frequent one, in (0, 1].
    """

    participant: str
    answers: int
    share: float


def straight_lining(answers: pd.DataFrame) -> tuple[StraightLine, ...]:
    """Measure how alike each participant's answers are, in the order of appearance.

    Parameters
    ----------
    answers : DataFrame
        Columns `participant` and `value`, as it was chosen on the page (the side, not the
        condition).
    """
    times = answers.groupby(["participant", "value"], sort=False, observed=True).size()
    each = times.groupby(level=0, sort=False, observed=True)
    return tuple(
        StraightLine(participant=str(name), answers=int(total), share=float(most / total))
        for (name, total), most in zip(each.sum().items(), each.max(), strict=True)
    )


@dataclass(frozen=True, kw_only=True)
class StraightLining:
    """Who gives one answer again and again.

    Attributes
    ----------
    limit : float
        Share of the commonest answer from which a participant is listed.
    participants : mapping of participant to float
        That share of those who are.
    """

    limit: float
    participants: Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class Quality:
    """How all participants answered, the excluded ones included."""

    response_seconds: ResponseTimes
    straight_lining: StraightLining


def quality(everyone: pd.DataFrame) -> Quality:
    """Describe how main and repeated trials were answered.

    Parameters
    ----------
    everyone : DataFrame
        Answers, those of excluded participants included.
    """
    people = pd.Categorical(everyone["participant"])
    lines = straight_lining(everyone.assign(value=everyone["value"].round()))
    return Quality(
        response_seconds=response_times(everyone["seconds"].to_numpy(np.float64), people),
        straight_lining=StraightLining(
            limit=ALIKE,
            participants={one.participant: one.share for one in lines if one.share >= ALIKE},
        ),
    )
