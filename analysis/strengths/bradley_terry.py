"""Bradley-Terry strengths from pairwise preferences, with ties and a left-side effect."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from analysis.strengths.choices import ChoiceFit, Choices, Situation, fit_choices
from analysis.strengths.identified import why_not_identified
from analysis.strengths.two_way import ONE_PARTICIPANT, TwoWayErrors, deviations
from motion.errors import InputError

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]
Ties = Literal["davidson", "half"]

PART: Final = 32_768
"""Answers counted at a time: as many as stay near the processor."""

ROOM: Final = 8
"""Kinds of answers of all participants, for each answer, up to which all are counted out."""


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
    segment : ndarray of int, shape (N,), or None
        Which segment it is about, from 0; None where that is not known.
    """

    conditions: tuple[str, ...]
    left: Codes
    right: Codes
    outcome: Codes
    participant: Codes
    segment: Codes | None = None

    def __post_init__(self) -> None:
        """Refuse a pair of a condition with itself."""
        if (self.left == self.right).any():
            raise InputError("an answer compares a condition with itself")

    @cached_property
    def tallies(self) -> tuple[Codes, Codes, Codes]:
        """Who answered what how often: participants, kinds of answers and numbers of them.

        A kind is 3 (left * conditions + right) + 1 - outcome. Where participants are too many to
        count out all that each could have answered, every answer stands for itself.
        """
        count = len(self.conditions)
        kinds, people = 3 * count**2, int(self.participant.max(initial=-1)) + 1
        cells = np.empty(len(self.participant), np.intp)
        # Part by part and in place: a million answers are counted as fast as they can be read.
        for start in range(0, len(cells), PART):
            part = slice(start, start + PART)
            own = cells[part]
            np.multiply(self.participant[part], count, out=own)
            own += self.left[part]
            own *= count
            own += self.right[part]
            own *= 3
            own -= self.outcome[part]
            own += 1
        if people * kinds > ROOM * len(cells):
            return cells // kinds, cells % kinds, np.ones(len(cells), np.intp)
        counted = np.bincount(cells, minlength=people * kinds)
        filled = np.flatnonzero(counted)
        return filled // kinds, filled % kinds, counted[filled]

    @cached_property
    def table(self) -> Floats:
        """How often left won, nobody did and right won, shape (left, right, 3)."""
        count = len(self.conditions)
        _, kinds, times = self.tallies
        found = np.bincount(kinds, weights=times, minlength=3 * count**2)
        return np.asarray(found, np.float64).reshape(count, count, 3)

    @property
    def beats(self) -> Floats:
        """How often each condition was preferred to each other one; ties count for both."""
        left, tie, right = np.moveaxis(self.table, 2, 0)
        return np.asarray(left + tie + (right + tie).T)

    @property
    def participants(self) -> int:
        """How many have answered."""
        return int(np.count_nonzero(np.bincount(self.tallies[0])))


@dataclass(frozen=True, kw_only=True)
class BradleyTerry:
    """Strengths on the log scale; they add up to zero.

    Attributes
    ----------
    conditions : tuple of str
        In the order of everything else.
    strengths : ndarray, shape (conditions,)
        Log strengths; NaN where they are not identified.
    covariance : ndarray, shape (conditions, conditions)
        Of the strengths, clustered by participant (CR0).
    errors, errors_by_model, errors_robust : ndarray, shape (conditions,)
        Standard errors: clustered by participant; of the model; robust but not clustered.
    two_way : TwoWayErrors or None
        Errors clustered by participant and segment; None where segments are not known, or there
        is one of either.
    tie : float or None
        Davidson's log nu: how likely ties are among equals; None where ties are halved.
    tie_error : float
        Its clustered standard error; NaN where there is none.
    left : float or None
        The left side's advantage in logits; None where it was not asked for.
    left_error : float
        Its clustered standard error; NaN where there is none.
    log_likelihood : float
        At the estimates.
    answers, participants : int
        What it rests on.
    reason : str
        Why there are no strengths; empty where there are. `remark` says why they have no errors.
    """

    conditions: tuple[str, ...]
    strengths: Floats
    covariance: Floats
    errors: Floats
    errors_by_model: Floats
    errors_robust: Floats
    two_way: TwoWayErrors | None
    tie: float | None
    tie_error: float
    left: float | None
    left_error: float
    log_likelihood: float
    answers: int
    participants: int
    reason: str = ""

    @property
    def remark(self) -> str:
        """Why clustered errors are NaN although there are strengths; empty where they are not."""
        return ONE_PARTICIPANT if self.participants < 2 and not self.reason else ""

    @property
    def errors_two_way(self) -> Floats:
        """Standard errors clustered by participant and segment; NaN where there are none."""
        none = np.full(len(self.conditions), math.nan)
        return none if self.two_way is None else self.two_way.errors


def bradley_terry(votes: Votes, *, ties: Ties = "davidson", left: bool = True) -> BradleyTerry:
    """Fit Bradley-Terry strengths.

    With strengths p and a left advantage g, the left one is preferred, tied with, or worse than
    the right one in the proportion g p_left : nu sqrt(g p_left p_right) : p_right (Davidson 1970;
    the left-side term as in Davidson & Beaver 1977).

    Parameters
    ----------
    votes : Votes
        Who preferred what to what.
    ties : {'davidson', 'half'}
        Model ties, or give half a vote to each side and model wins alone.
    left : bool
        Whether the left side may have an advantage.
    """
    count, modelled = len(votes.conditions), ties == "davidson"
    reason = why_not_identified(votes.beats, votes.conditions) if len(votes.left) else "no answers"
    if modelled and not reason and not votes.table[..., 1].any():
        # Without any tie their frequency has no estimate; the model without it is the same.
        modelled = False
    if reason:
        return unknown(votes, reason)
    shown = votes.table.sum(axis=2).ravel() > 0
    pairs, place = np.flatnonzero(shown), np.cumsum(shown) - 1
    situations = tuple(
        _situation(int(pair) // count, int(pair) % count, count, modelled, left) for pair in pairs
    )
    people, kinds, times = votes.tallies
    fit = fit_choices(
        Choices(
            situations=situations,
            situation=place[kinds // 3],
            way=kinds % 3,
            cluster=people,
            times=times,
        )
    )
    kind = 3 * place[votes.left * count + votes.right] + 1 - votes.outcome
    return centred(votes, fit, kind, modelled, left)


def _situation(first: int, second: int, count: int, modelled: bool, left: bool) -> Situation:
    """Return left win, tie and right win; the first condition's log strength is zero."""
    strength = np.eye(count)[:, 1:]
    extra = int(modelled) + int(left)
    wins = np.zeros((2, count - 1 + extra))
    wins[0, : count - 1], wins[1, : count - 1] = strength[first], strength[second]
    if left:
        wins[0, -1] = 1.0
    if not modelled:
        return Situation(features=wins, ways=np.array([[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]]))
    tie = wins.mean(axis=0)
    tie[count - 1] += 1.0
    return Situation(features=np.stack([wins[0], tie, wins[1]]), ways=np.eye(3))


def centred(votes: Votes, fit: ChoiceFit, kind: Codes, modelled: bool, left: bool) -> BradleyTerry:
    """Return strengths that add up to zero from those relative to the first condition.

    Parameters
    ----------
    fit : ChoiceFit
        Of the other conditions' log strengths, then the tie where `modelled`, then the left
        side's advantage where `left`.
    kind : ndarray of int, shape (N,)
        Each answer's row among `fit.influences`.
    """
    count = len(votes.conditions)
    turn = np.eye(count)[:, 1:] - 1 / count
    strengths, covariances = (
        turn @ fit.estimates[: count - 1],
        [
            turn @ part[: count - 1, : count - 1] @ turn.T
            for part in (fit.clustered, fit.by_model, fit.robust)
        ],
    )
    errors = deviations(fit.clustered)
    influences = fit.influences[:, : count - 1] @ turn.T
    return BradleyTerry(
        conditions=votes.conditions,
        strengths=strengths,
        covariance=covariances[0],
        errors=deviations(covariances[0]),
        errors_by_model=deviations(covariances[1]),
        errors_robust=deviations(covariances[2]),
        two_way=None
        if votes.segment is None
        else TwoWayErrors.of(influences, kind, votes.participant, votes.segment),
        tie=float(fit.estimates[count - 1]) if modelled else None,
        tie_error=float(errors[count - 1]) if modelled else math.nan,
        left=float(fit.estimates[-1]) if left else None,
        left_error=float(errors[-1]) if left else math.nan,
        log_likelihood=fit.log_likelihood,
        answers=fit.choices,
        participants=votes.participants,
        reason="" if fit.converged else "the strengths did not converge",
    )


def unknown(votes: Votes, reason: str) -> BradleyTerry:
    """Return a result without strengths, which says why there are none."""
    count = len(votes.conditions)
    none = np.full(count, math.nan)
    return BradleyTerry(
        conditions=votes.conditions,
        strengths=none,
        covariance=np.full((count, count), math.nan),
        errors=none,
        errors_by_model=none,
        errors_robust=none,
        two_way=None,
        tie=None,
        tie_error=math.nan,
        left=None,
        left_error=math.nan,
        log_likelihood=math.nan,
        answers=len(votes.left),
        participants=votes.participants,
        reason=reason,
    )


def votes_of(
    left: Sequence[str],
    right: Sequence[str],
    outcome: Sequence[int],
    participant: Sequence[str],
    *,
    conditions: Sequence[str] = (),
    segment: Sequence[str] | None = None,
) -> Votes:
    """Return named answers as numbers; conditions in order of appearance unless given."""
    names = tuple(conditions) or tuple(
        dict.fromkeys(name for pair in zip(left, right, strict=True) for name in pair)
    )
    number = {name: place for place, name in enumerate(names)}
    people = np.unique(np.asarray(participant, str), return_inverse=True)[1]
    return Votes(
        conditions=names,
        left=np.array([number[name] for name in left], np.intp),
        right=np.array([number[name] for name in right], np.intp),
        outcome=np.asarray(outcome, np.intp),
        participant=people.astype(np.intp),
        segment=None
        if segment is None
        else np.unique(np.asarray(segment, str), return_inverse=True)[1].astype(np.intp),
    )
