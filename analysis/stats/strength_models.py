"""Models of strengths: Bradley and Terry's for pairs, Plackett and Luce's for rankings.

A ranking, complete or partial, repeatedly chooses the best of the remaining conditions, with
probabilities proportional to their worths. A tie is the choice of a set, whose weight is the
geometric mean of its members' worths times a parameter for ties of that size (Turner, van Etten,
Firth & Kosmidis 2020).
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from typing import Final

import numpy as np
import pandas as pd

from analysis.stats.strength_differences import standard_errors
from analysis.stats.strengths import (
    Choices,
    FittedStrengths,
    centring,
    fit_choices,
    links,
    strength_fields,
    unknown_strengths,
)
from motion.arrays import Bools, Floats, Indices

ALL_TIED: Final = "every ranking ties all that it places"


@dataclass(frozen=True, kw_only=True)
class Votes:
    """Pairwise preferences as numbers, one row for each answer.

    Attributes
    ----------
    conditions : tuple of str
        Names of all conditions.
    left, right : ndarray of int, shape (N,)
        The conditions shown on the left and on the right, which differ.
    outcome : ndarray of int, shape (N,)
        1 if the left one was preferred, 0 for a tie, -1 if the right one was.
    participant, segment : ndarray of int, shape (N,)
        The participant and the segment of each answer, from 0.
    """

    conditions: tuple[str, ...]
    left: Indices
    right: Indices
    outcome: Indices
    participant: Indices
    segment: Indices

    @cached_property
    def pair(self) -> Indices:
        """The ordered pair of each answer, as left * conditions + right."""
        return self.left * len(self.conditions) + self.right

    @cached_property
    def table(self) -> Floats:
        """Numbers of wins of the left, ties, and wins of the right, shape (left, right, 3)."""
        count = len(self.conditions)
        counts = np.bincount(3 * self.pair + 1 - self.outcome, minlength=3 * count**2)
        return np.asarray(counts, np.float64).reshape(count, count, 3)

    @property
    def beats(self) -> Floats:
        """How often each condition was preferred to each other condition; ties count for both."""
        left, tie, right = np.moveaxis(self.table, 2, 0)
        return np.asarray(left + tie + (right + tie).T)


@dataclass(frozen=True, kw_only=True)
class BradleyTerry(FittedStrengths):
    """Strengths of conditions that were compared in pairs.

    Attributes
    ----------
    tie, tie_error : float
        Davidson's log nu, which determines how likely ties are between equals, and its clustered
        standard error; NaN if there are no ties.
    left, left_error : float
        The left side's advantage in logits, and its clustered standard error; NaN if the model has
        none.
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
        The preferences.
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
    # Without ties their frequency has no estimate, and the model omits it.
    has_ties = bool(votes.table[..., 1].any())
    alternatives = 2 + has_ties
    occurs = votes.table.any(axis=2).ravel()
    pairs, situation = np.flatnonzero(occurs), (np.cumsum(occurs) - 1)[votes.pair]
    choices = Choices(
        features=np.concatenate(
            [
                _alternatives(pair // count, pair % count, count, has_ties, left_effect)
                for pair in pairs.tolist()
            ]
        ),
        sizes=[alternatives] * len(pairs),
        chosen=alternatives * situation + (1 - votes.outcome) * (alternatives - 1) // 2,
        participant=votes.participant,
        segment=votes.segment,
    )
    fit = fit_choices(choices, _prior(count, has_ties, left_effect) if linked.unbeaten else None)
    if not fit.converged:
        return replace(unknown, reason="the strengths did not converge")
    errors = standard_errors(fit.clustered)
    return replace(
        unknown,
        **strength_fields(linked, choices, fit),
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


def _alternatives(first: int, second: int, count: int, has_ties: bool, left_effect: bool) -> Floats:
    """Return the features of left win, tie and right win; the first log strength is zero."""
    wins = np.zeros((2, count - 1 + has_ties + left_effect))
    wins[:, : count - 1] = np.eye(count)[[first, second], 1:]
    if left_effect:
        wins[0, -1] = 1.0
    if not has_ties:
        return wins
    tie = wins.mean(axis=0)
    tie[count - 1] += 1.0
    return np.stack([wins[0], tie, wins[1]])


Stage = tuple[frozenset[int], frozenset[int]]
"""The remaining conditions, and those placed next."""


@dataclass(frozen=True, kw_only=True)
class PlackettLuce(FittedStrengths):
    """Worths of conditions that were ranked.

    Attributes
    ----------
    ties : mapping of int to float
        For each size of tie that occurs, the logarithm of its parameter.
    """

    ties: dict[int, float] = field(default_factory=dict)


def plackett_luce(rankings: pd.DataFrame, conditions: Sequence[str]) -> PlackettLuce:
    """Fit worths to rankings.

    Parameters
    ----------
    rankings : DataFrame
        Columns `ranking` (identifies a ranking), `participant`, `segment`, `condition` and `rank`
        (1 is best, equal numbers are a tie). A ranking may omit conditions, and places none twice.
    conditions : sequence of str
        All conditions, in order.

    """
    names = tuple(conditions)
    stages, rows = _stages(rankings, names)
    linked = links(_wins(stages, len(names)), names)
    unknown = PlackettLuce(
        conditions=names,
        **unknown_strengths(len(names)),
        n=int(rankings["ranking"].nunique()),
        participants=int(rankings["participant"].nunique()),
    )
    if all(remaining == chosen for remaining, chosen in stages):
        return replace(unknown, reason=ALL_TIED)
    if linked.unlinked:
        return replace(unknown, reason=linked.unlinked)
    sizes = sorted({len(chosen) for _, chosen in stages} - {1})
    choosable = {
        remaining: _choosable(remaining, sizes)
        for remaining in dict.fromkeys(remaining for remaining, _ in stages)
    }
    kinds = {
        stage: kind
        for kind, stage in enumerate(
            (remaining, chosen) for remaining, sets in choosable.items() for chosen in sets
        )
    }
    choices = Choices(
        features=np.array([_features(chosen, len(names), sizes) for _, chosen in kinds]),
        sizes=[len(sets) for sets in choosable.values()],
        chosen=np.array([kinds[stage] for stage in stages], np.intp),
        participant=pd.factorize(rankings["participant"])[0][rows],
        segment=pd.factorize(rankings["segment"])[0][rows],
    )
    prior = np.hstack([centring(len(names)), np.zeros((len(names), len(sizes)))])
    fit = fit_choices(choices, prior if linked.unbeaten else None)
    if not fit.converged:
        return replace(unknown, reason="the worths did not converge")
    return replace(
        unknown,
        **strength_fields(linked, choices, fit),
        ties=dict(zip(sizes, fit.estimates[len(names) - 1 :].tolist(), strict=True)),
    )


def _stages(rankings: pd.DataFrame, names: Sequence[str]) -> tuple[list[Stage], Indices]:
    """Return every choice of the next best, and a row of its ranking."""
    number = {name: place for place, name in enumerate(names)}
    levels_of: dict[object, dict[float, set[int]]] = {}
    row_of: dict[object, int] = {}
    columns = (rankings[name].tolist() for name in ("ranking", "condition", "rank"))
    for row, (ranking, condition, rank) in enumerate(zip(*columns, strict=True)):
        if not math.isnan(rank):
            levels_of.setdefault(ranking, {}).setdefault(rank, set()).add(number[condition])
            row_of.setdefault(ranking, row)
    stages: list[Stage] = []
    rows: list[int] = []
    for ranking, levels in levels_of.items():
        remaining = frozenset[int]().union(*levels.values())
        for _, level in sorted(levels.items()):
            if len(remaining) > 1:
                stages.append((remaining, frozenset(level)))
                rows.append(row_of[ranking])
            remaining -= level
    return stages, np.array(rows, np.intp)


def _wins(stages: Sequence[Stage], count: int) -> Floats:
    """Return how often the row's condition was placed ahead of or tied with the column's."""
    wins = np.zeros((count, count))
    for (remaining, level), times in Counter(stages).items():
        for better in level:
            wins[better, list(remaining - {better})] += times
    return wins


def _choosable(remaining: frozenset[int], sizes: Sequence[int]) -> list[frozenset[int]]:
    """Return all sets that can be placed next."""
    return [
        frozenset(chosen)
        for size in (1, *sizes)
        if size <= len(remaining)
        for chosen in combinations(sorted(remaining), size)
    ]


def _features(chosen: frozenset[int], count: int, sizes: Sequence[int]) -> Floats:
    """Return the weights of the members' log worths, and an indicator of the size of the tie."""
    members = np.eye(count)[sorted(chosen)].mean(axis=0)[1:]
    return np.concatenate([members, [float(len(chosen) == size) for size in sizes]])


PSEUDO_VOTES: Final = 0.01
"""Votes added for each side of every compared pair, so that strengths stay finite if one side
always won."""

_STEPS: Final = 100

_LONGEST_STEP: Final = 1.5

_CLOSE: Final = 1e-9


def fit_strengths_of_tables(wins: Floats) -> Floats:
    """Fit a Bradley-Terry model, with ties as half wins, to each of many tables of wins.

    Parameters
    ----------
    wins : ndarray, shape (B, k, k)
        How often the row's condition was preferred to the column's, plus half of the ties.

    Returns
    -------
    ndarray, shape (B, k)
        Log strengths that sum to zero; NaN if the compared pairs do not connect all conditions.
    """
    count = wins.shape[-1]
    compared = (wins + wins.swapaxes(1, 2)) > 0
    usable = _connected(compared)
    won = wins[usable] + PSEUDO_VOTES * compared[usable]
    votes = won + won.swapaxes(1, 2)
    strengths = np.zeros((len(won), count))
    # A constant added to all strengths changes nothing: this fixes their mean.
    fixed = np.full((count, count), 1 / count)
    for _ in range(_STEPS):
        chance = 1 / (1 + np.exp(strengths[:, None, :] - strengths[:, :, None]))
        gradient = (won - votes * chance).sum(axis=2)
        weights = votes * chance * (1 - chance)
        information = -weights
        information[:, np.arange(count), np.arange(count)] = weights.sum(axis=2)
        step = np.linalg.solve(information + fixed, gradient[..., None])[..., 0]
        longest = np.abs(step).max(axis=1, keepdims=True, initial=0)
        step *= np.minimum(1, _LONGEST_STEP / np.maximum(longest, _CLOSE))
        strengths += step
        if np.abs(step).max(initial=0) < _CLOSE:
            break
    centred = np.full(wins.shape[:2], np.nan)
    centred[usable] = strengths - strengths.mean(axis=1, keepdims=True)
    return centred


def _connected(compared: Bools) -> Bools:
    """Return which of the graphs, shape (B, k, k), are connected."""
    count = compared.shape[-1]
    reached = compared | np.eye(count, dtype=bool)
    for _ in range(max(1, count - 1).bit_length()):
        reached = np.matmul(reached.astype(np.float32), reached.astype(np.float32)) > 0
    return np.asarray(reached.all(axis=(1, 2)))
