"""Plackett-Luce worths of conditions, and the ranks they may have."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.results.grouping import codes, shown_conditions
from analysis.results.strength_errors import RankInterval, strength_errors
from analysis.results.strengths import named, remark_of
from analysis.strengths.plackett_luce import plackett_luce


@dataclass(frozen=True, kw_only=True)
class Worths:
    """Plackett-Luce worths, partial and tied rankings included.

    Attributes
    ----------
    worths, errors : mapping of condition to float
        Log worths, which add up to zero, and their errors clustered by participant.
    errors_two_way, low, high : mapping of condition to float
        Errors clustered by participant and segment, and the ends of the 95 % intervals.
    ranks : mapping of condition to RankInterval
        At 95 %, all together.
    ties : mapping of int to float
        For each size of tie that occurs, the logarithm of its parameter.
    loglik : float
        At the estimates.
    n, participants, segments : int
        What it rests on.
    method : str
        Which errors the intervals and ranks rest on.
    remark, reason : str
        What limits the result; why there is none.
    """

    worths: Mapping[str, float]
    errors: Mapping[str, float]
    errors_two_way: Mapping[str, float]
    low: Mapping[str, float]
    high: Mapping[str, float]
    ranks: Mapping[str, RankInterval]
    ties: Mapping[int, float]
    loglik: float
    n: int
    participants: int
    segments: int
    method: str
    remark: str
    reason: str


def worths_of(answers: pd.DataFrame) -> Worths:
    """Fit worths to the rankings of one question."""
    names = shown_conditions(answers)
    who = codes(answers, "participant")
    ranking = who * len(answers["segment"].cat.categories) + codes(answers, "segment")
    rows = pd.DataFrame(
        {
            "ranking": ranking,
            "condition": answers["condition"].to_numpy(object),
            "rank": answers["value"].to_numpy(),
            "participant": who,
            "segment": codes(answers, "segment"),
        }
    )
    found = plackett_luce(rows, conditions=names)
    known = not found.reason
    segments = len(np.unique(codes(answers, "segment")))
    return Worths(
        worths=named(names, found.worths, hide=not known),
        errors=named(names, found.errors, hide=not known),
        **vars(
            strength_errors(
                names,
                found.worths,
                found.covariance,
                found.two_way,
                participants=found.participants,
                known=known,
            )
        ),
        ties=found.ties if known else {},
        loglik=found.log_likelihood if known else math.nan,
        n=found.rankings,
        participants=found.participants,
        segments=segments,
        remark=remark_of(found.remark, segments=segments),
        reason=found.reason,
    )
