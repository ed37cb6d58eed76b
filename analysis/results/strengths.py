"""Strengths of conditions over all their comparisons, and the ranks they may have."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.results.grouping import codes
from analysis.results.strength_errors import ONE_SEGMENT, RankInterval, strength_errors
from analysis.strengths.bradley_terry import bradley_terry
from analysis.strengths.votes import Votes


@dataclass(frozen=True, kw_only=True)
class Strengths:
    """Bradley-Terry strengths with Davidson's ties and a left-side term.

    Attributes
    ----------
    strengths, errors : mapping of condition to float
        Log strengths, which add up to zero, and their errors clustered by participant.
    errors_two_way, low, high : mapping of condition to float
        Errors clustered by participant and segment, and the ends of the 95 % intervals.
    ranks : mapping of condition to RankInterval
        At 95 %, all together.
    tie, tie_error : float
        Davidson's log nu: how likely ties are among equals; NaN where nobody tied.
    left, left_error : float
        The left side's advantage in logits.
    loglik : float
        At the estimates.
    n, participants, segments : int
        What it rests on.
    method : str
        Which errors the intervals and ranks rest on.
    remark, reason : str
        What limits the result; why there is none.
    """

    strengths: Mapping[str, float]
    errors: Mapping[str, float]
    errors_two_way: Mapping[str, float]
    low: Mapping[str, float]
    high: Mapping[str, float]
    ranks: Mapping[str, RankInterval]
    tie: float
    tie_error: float
    left: float
    left_error: float
    loglik: float
    n: int
    participants: int
    segments: int
    method: str
    remark: str
    reason: str


def strengths_of(answers: pd.DataFrame) -> Strengths:
    """Fit strengths to pairwise answers to one question."""
    left, right = codes(answers, "left"), codes(answers, "right")
    shown, number = np.unique(np.concatenate([left, right]), return_inverse=True)
    names = tuple(str(answers["left"].cat.categories[place]) for place in shown)
    found = bradley_terry(
        Votes(
            conditions=names,
            left=number[: len(left)].astype(np.intp),
            right=number[len(left) :].astype(np.intp),
            outcome=np.sign(3 - answers["value"].to_numpy()).astype(np.intp),
            participant=_numbered(answers, "participant"),
            segment=_numbered(answers, "segment"),
        )
    )
    if not (answers["value"] != 3).any():
        found = replace(found, reason="all answers are ties")
    segments = len(np.unique(codes(answers, "segment")))
    no_ties = found.tie is None and not found.reason
    known = not found.reason
    return Strengths(
        strengths=named(names, found.strengths, hide=not known),
        errors=named(names, found.errors, hide=not known),
        **vars(
            strength_errors(
                names,
                found.strengths,
                found.covariance,
                found.two_way,
                participants=found.participants,
                known=known,
            )
        ),
        tie=found.tie if known and found.tie is not None else math.nan,
        tie_error=found.tie_error if known else math.nan,
        left=found.left if known and found.left is not None else math.nan,
        left_error=found.left_error if known else math.nan,
        loglik=found.log_likelihood if known else math.nan,
        n=found.answers,
        participants=found.participants,
        segments=segments,
        remark=remark_of(found.remark, "nobody answered with a tie" * no_ties, segments=segments),
        reason=found.reason,
    )


def named(names: tuple[str, ...], values: NDArray[np.float64], *, hide: bool) -> dict[str, float]:
    """Return numbers by condition, NaN where they mean nothing."""
    return {
        name: math.nan if hide else float(value) for name, value in zip(names, values, strict=True)
    }


def remark_of(*remarks: str, segments: int) -> str:
    """Return the remarks that are not empty, and that there is one segment where there is."""
    said = [remark for remark in remarks if remark]
    return "; ".join([*said, *([ONE_SEGMENT] if segments == 1 else [])])


def _numbered(answers: pd.DataFrame, column: str) -> NDArray[np.intp]:
    """Return a column of names as numbers from 0 without gaps."""
    return np.unique(codes(answers, column), return_inverse=True)[1].astype(np.intp)
