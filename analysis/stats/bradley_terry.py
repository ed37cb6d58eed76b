"""Bradley-Terry strengths from pairwise preferences, with ties by Davidson."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.stats.choices import ChoiceFit, Choices, Situation, fit_choices
from analysis.stats.strength_differences import deviations
from analysis.stats.strengths import Links, Strengths, centring, fitted, links, unknown
from motion.errors import InputError

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

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
class BradleyTerry(Strengths):
    """Strengths of conditions that were compared in pairs.

    Attributes
    ----------
    tie : float or None
        Davidson's log nu: how likely ties are among equals; None where there is no tie.
    tie_error : float
        Its clustered standard error; NaN where there is none.
    left : float or None
        The left side's advantage in logits; None where it was not asked for.
    left_error : float
        Its clustered standard error; NaN where there is none.
    """

    tie: float | None = None
    tie_error: float = math.nan
    left: float | None = None
    left_error: float = math.nan


def bradley_terry(votes: Votes, *, left: bool = True) -> BradleyTerry:
    """Fit Bradley-Terry strengths.

    With strengths p and a left advantage g, the left one is preferred, tied with, or worse than
    the right one in the proportion g p_left : nu sqrt(g p_left p_right) : p_right (Davidson 1970;
    the left-side term as in Davidson & Beaver 1977).

    Parameters
    ----------
    votes : Votes
        Who preferred what to what.
    left : bool
        Whether the left side may have an advantage.
    """
    count = len(votes.conditions)
    linked = links(votes.beats, votes.conditions)
    if reason := linked.apart if len(votes.left) else "no answers":
        return _without_strengths(votes, reason)
    # Without any tie their frequency has no estimate; the model without it is the same.
    modelled = bool(votes.table[..., 1].any())
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
        ),
        _prior(count, modelled, left) if linked.swept else None,
    )
    if votes.segment is None:
        return _centred(votes, fit, None, linked, modelled, left)
    kind = 3 * place[votes.left * count + votes.right] + 1 - votes.outcome
    return _centred(votes, fit, kind, linked, modelled, left)


def _prior(count: int, modelled: bool, left: bool) -> Floats:
    """Return one comparison of each condition with the average, and one of the sides."""
    rows = np.zeros((count + left, count - 1 + modelled + left))
    rows[:count, : count - 1] = centring(count)
    if left:
        rows[-1, -1] = 1.0
    return rows


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


def _centred(
    votes: Votes, fit: ChoiceFit, kind: Codes | None, linked: Links, modelled: bool, left: bool
) -> BradleyTerry:
    """Return strengths that add up to zero from those relative to the first condition.

    Parameters
    ----------
    fit : ChoiceFit
        Of the other conditions' log strengths, then the tie where `modelled`, then the left
        side's advantage where `left`.
    kind : ndarray of int, shape (N,), or None
        Each answer's row among `fit.influences`; needed where segments are known.
    """
    count = len(votes.conditions)
    errors = deviations(fit.clustered)
    return BradleyTerry(
        conditions=votes.conditions,
        **fitted(linked, fit, kind, votes.participant, votes.segment),
        tie=float(fit.estimates[count - 1]) if modelled else None,
        tie_error=float(errors[count - 1]) if modelled else math.nan,
        left=float(fit.estimates[-1]) if left else None,
        left_error=float(errors[-1]) if left else math.nan,
        n=fit.choices,
        participants=votes.participants,
        reason="" if fit.converged else "the strengths did not converge",
    )


def _without_strengths(votes: Votes, reason: str) -> BradleyTerry:
    """Return a result without strengths, which says why there are none."""
    return BradleyTerry(
        conditions=votes.conditions,
        **unknown(len(votes.conditions)),
        n=len(votes.left),
        participants=votes.participants,
        reason=reason,
    )
