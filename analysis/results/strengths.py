"""Strengths of conditions over all their comparisons, and the ranks they may have."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.results.grouping import codes, people
from analysis.strengths.bradley_terry import Votes, bradley_terry
from analysis.strengths.rank_intervals import rank_intervals

ONE_PARTICIPANT = "one participant: no errors, because nothing tells how people differ"


@dataclass(frozen=True, kw_only=True)
class RankInterval:
    """The best and the worst rank that a condition may have, from 1."""

    best: int
    worst: int


@dataclass(frozen=True, kw_only=True)
class Strengths:
    """Bradley-Terry strengths with Davidson's ties and a left-side term.

    Attributes
    ----------
    strengths, errors : mapping of condition to float
        Log strengths, which add up to zero, and their errors clustered by participant.
    ranks : mapping of condition to RankInterval
        At 95 %.
    tie, tie_error : float
        Davidson's log nu: how likely ties are among equals; NaN where nobody tied.
    left, left_error : float
        The left side's advantage in logits.
    loglik : float
        At the estimates.
    n, participants : int
        What it rests on.
    remark, reason : str
        What limits the result; why there is none.
    """

    strengths: Mapping[str, float]
    errors: Mapping[str, float]
    ranks: Mapping[str, RankInterval]
    tie: float
    tie_error: float
    left: float
    left_error: float
    loglik: float
    n: int
    participants: int
    remark: str
    reason: str


def strengths_of(answers: pd.DataFrame) -> Strengths:
    """Fit strengths to pairwise answers to one question."""
    left, right = codes(answers, "left"), codes(answers, "right")
    shown, number = np.unique(np.concatenate([left, right]), return_inverse=True)
    names = tuple(str(answers["left"].cat.categories[place]) for place in shown)
    who = np.unique(codes(answers, "participant"), return_inverse=True)[1]
    found = bradley_terry(
        Votes(
            conditions=names,
            left=number[: len(left)].astype(np.intp),
            right=number[len(left) :].astype(np.intp),
            outcome=np.sign(3 - answers["value"].to_numpy()).astype(np.intp),
            participant=who.astype(np.intp),
        )
    )
    alone = people(answers) < 2
    all_tied = not (answers["value"] != 3).any()
    unknown = bool(found.reason) or all_tied
    hidden = alone or unknown
    return Strengths(
        strengths=named(names, found.strengths, hide=unknown),
        errors=named(names, found.errors, hide=hidden),
        ranks={} if hidden else ranks_of(names, found.strengths, found.covariance, who),
        tie=math.nan if found.tie is None or unknown else found.tie,
        tie_error=math.nan if hidden else found.tie_error,
        left=math.nan if found.left is None or unknown else found.left,
        left_error=math.nan if hidden else found.left_error,
        loglik=math.nan if unknown else found.log_likelihood,
        n=found.answers,
        participants=found.participants,
        remark=_remark(alone, found.tie is None and not unknown),
        reason="all answers are ties" if all_tied else found.reason,
    )


def named(names: tuple[str, ...], values: NDArray[np.float64], *, hide: bool) -> dict[str, float]:
    """Return numbers by condition, NaN where they mean nothing."""
    return {
        name: math.nan if hide else float(value) for name, value in zip(names, values, strict=True)
    }


def ranks_of(
    names: tuple[str, ...],
    strengths: NDArray[np.float64],
    covariance: NDArray[np.float64],
    participants: NDArray[np.integer],
) -> dict[str, RankInterval]:
    """Return the ranks that conditions may have."""
    freedom = len(np.unique(participants)) - 1
    found = rank_intervals(strengths, covariance, freedom=freedom)
    return {
        name: RankInterval(best=best, worst=worst)
        for name, (best, worst) in zip(names, found, strict=True)
    }


def _remark(alone: bool, no_ties: bool) -> str:
    remarks = [ONE_PARTICIPANT] if alone else []
    remarks += ["nobody answered with a tie"] if no_ties else []
    return "; ".join(remarks)
