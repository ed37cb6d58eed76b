"""Bradley-Terry strengths from pairwise preferences, with ties by Davidson."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analysis.stats.choices import Choices, Situation, fit_choices
from analysis.stats.strength_differences import standard_errors
from analysis.stats.strengths import (
    FittedStrengths,
    centring,
    links,
    strength_fields,
    unknown_strengths,
)
from motion.errors import InputError

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


@dataclass(frozen=True, kw_only=True)
class Votes:
    """Pairwise preferences as numbers, one row for each answer.

    Attributes
    ----------
    conditions : tuple of str
        Names of all conditions.
    left, right : ndarray of int, shape (N,)
        Which conditions were shown on the left and on the right.
    outcome : ndarray of int, shape (N,)
        1 where the left one was preferred, 0 for a tie, -1 where the right one was.
    participant : ndarray of int, shape (N,)
        Who answered, from 0.
    segment : ndarray of int, shape (N,)
        Which segment it is about, from 0.
    """

    conditions: tuple[str, ...]
    left: Codes
    right: Codes
    outcome: Codes
    participant: Codes
    segment: Codes

    def __post_init__(self) -> None:
        """Refuse a pair of a condition with itself."""
        if (self.left == self.right).any():
            raise InputError("an answer compares a condition with itself")

    @cached_property
    def kind(self) -> Codes:
        """Pair and outcome of each answer: 3 (left * conditions + right) + 1 - outcome."""
        return 3 * (self.left * len(self.conditions) + self.right) + 1 - self.outcome

    @cached_property
    def table(self) -> Floats:
        """How often left won, nobody did and right won, shape (left, right, 3)."""
        count = len(self.conditions)
        counts = np.bincount(self.kind, minlength=3 * count**2)
        return np.asarray(counts, np.float64).reshape(count, count, 3)

    @property
    def beats(self) -> Floats:
        """How often each condition was preferred to each other one; ties count for both."""
        left, tie, right = np.moveaxis(self.table, 2, 0)
        return np.asarray(left + tie + (right + tie).T)


@dataclass(frozen=True, kw_only=True)
class BradleyTerry(FittedStrengths):
    """Strengths of conditions that were compared in pairs.

    Attributes
    ----------
    tie, tie_error : float
        Davidson's log nu, which says how likely ties are among equals, and its clustered standard
        error; NaN where nobody answered with a tie.
    left, left_error : float
        The left side's advantage in logits, and its clustered standard error; NaN where the model
        has none.
    """

    tie: float = math.nan
    tie_error: float = math.nan
    left: float = math.nan
    left_error: float = math.nan


def bradley_terry(votes: Votes, *, left_effect: bool = True) -> BradleyTerry:
    """Fit Bradley-Terry strengths.

    With strengths p and a left advantage g, the left one is preferred, tied with, or worse than
    the right one in the proportion g p_left : nu sqrt(g p_left p_right) : p_right (Davidson 1970;
    the left-side term as in Davidson & Beaver 1977).

    Parameters
    ----------
    votes : Votes
        Who preferred what to what.
    left_effect : bool
        Whether the left side may have an advantage.
    """
    count = len(votes.conditions)
    linked = links(votes.beats, votes.conditions)
    unknown = BradleyTerry(
        conditions=votes.conditions,
        **unknown_strengths(count),
        n=len(votes.left),
        participants=len(np.unique(votes.participant)),
    )
    if not votes.outcome.any():
        reason = "all answers are ties" if len(votes.left) else "no answers"
        return replace(unknown, reason=reason)
    if linked.unlinked:
        return replace(unknown, reason=linked.unlinked)
    # Without any tie their frequency has no estimate; the model without it is the same.
    has_ties = bool(votes.table[..., 1].any())
    shown = votes.table.sum(axis=2).ravel() > 0
    situations = tuple(
        _situation(int(pair) // count, int(pair) % count, count, has_ties, left_effect)
        for pair in np.flatnonzero(shown)
    )
    number = np.cumsum(shown) - 1
    kind = 3 * number[votes.kind // 3] + votes.kind % 3
    kinds = 3 * len(situations)
    answered, times = np.unique(votes.participant * kinds + kind, return_counts=True)
    fit = fit_choices(
        Choices(
            situations=situations,
            kind=answered % kinds,
            cluster=answered // kinds,
            times=times,
        ),
        _prior(count, has_ties, left_effect) if linked.swept else None,
    )
    if not fit.converged:
        return replace(unknown, reason="the strengths did not converge")
    errors = standard_errors(fit.clustered)
    return replace(
        unknown,
        **strength_fields(linked, fit, kind, votes.participant, votes.segment),
        tie=float(fit.estimates[count - 1]) if has_ties else math.nan,
        tie_error=float(errors[count - 1]) if has_ties else math.nan,
        left=float(fit.estimates[-1]) if left_effect else math.nan,
        left_error=float(errors[-1]) if left_effect else math.nan,
    )


def _prior(count: int, has_ties: bool, left_effect: bool) -> Floats:
    """Return one comparison of each condition with the average, and one of the sides."""
    rows = np.zeros((count + left_effect, count - 1 + has_ties + left_effect))
    rows[:count, : count - 1] = centring(count)
    if left_effect:
        rows[-1, -1] = 1.0
    return rows


def _situation(first: int, second: int, count: int, has_ties: bool, left_effect: bool) -> Situation:
    """Return left win, tie and right win; the first condition's log strength is zero."""
    wins = np.zeros((2, count - 1 + has_ties + left_effect))
    wins[:, : count - 1] = np.eye(count)[[first, second], 1:]
    if left_effect:
        wins[0, -1] = 1.0
    if not has_ties:
        return Situation(features=wins, ways=np.array([[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]]))
    tie = wins.mean(axis=0)
    tie[count - 1] += 1.0
    return Situation(features=np.stack([wins[0], tie, wins[1]]), ways=np.eye(3))
