"""How answers were given: how fast, and how much alike; nobody is excluded by it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd

from analysis.answers.response_times import response_times
from analysis.answers.straight_lining import straight_lining
from analysis.results.grouping import codes

ALIKE: Final = 0.9
"""Share of one answer among all of a participant from which the participant is listed."""


@dataclass(frozen=True, kw_only=True)
class ResponseSeconds:
    """How long answers took.

    Attributes
    ----------
    median, low_quartile, high_quartile : float
        Of the participants' medians, in seconds.
    limit : float
        Half the median: below it a participant is too fast.
    too_fast : mapping of participant to float
        The medians of those who are.
    n, missing : int
        Answers whose time is known, and is not.
    reason : str
        Why there are no numbers.
    """

    median: float
    low_quartile: float
    high_quartile: float
    limit: float
    too_fast: Mapping[str, float]
    n: int
    missing: int
    reason: str


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

    response_seconds: ResponseSeconds
    straight_lining: StraightLining


def quality(everyone: pd.DataFrame) -> Quality:
    """Describe how main and repeated trials were answered.

    Parameters
    ----------
    everyone : DataFrame
        Answers, those of excluded participants included.
    """
    names = everyone["participant"].cat.categories
    who = codes(everyone, "participant")
    times = response_times(everyone["seconds"].to_numpy(np.float64), who)
    lines = straight_lining(everyone.assign(value=everyone["value"].round()))
    return Quality(
        response_seconds=ResponseSeconds(
            median=times.median,
            low_quartile=times.quartiles[0],
            high_quartile=times.quartiles[1],
            limit=times.limit,
            too_fast={
                str(names[int(one.participant)]): one.median
                for one in times.participants
                if one.too_fast
            },
            n=times.answers,
            missing=times.missing,
            reason=times.reason if math.isnan(times.median) else "",
        ),
        straight_lining=StraightLining(
            limit=ALIKE,
            participants={
                one.participant: one.commonest_share
                for one in lines
                if one.commonest_share >= ALIKE
            },
        ),
    )
