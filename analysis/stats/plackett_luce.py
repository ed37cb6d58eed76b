"""Plackett-Luce worths from rankings, whole or partial, with ties.

The best of the conditions still to be placed is chosen again and again, each with a probability
proportional to its worth. A tie is the choice of a set, whose weight is the geometric mean of its
members' worths times a parameter for ties of that size (Turner, van Etten, Firth & Kosmidis 2020).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.stats.choices import Choices, Situation, fit_choices
from analysis.stats.strengths import (
    FittedStrengths,
    centring,
    links,
    strength_fields,
    unknown_strengths,
)
from motion.errors import InputError

Floats = NDArray[np.float64]

Stage = tuple[frozenset[int], frozenset[int]]
"""The conditions still to be placed, and those placed next."""


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
        Columns `ranking` (names one ranking), `participant`, `segment`, `condition` and `rank`
        (1 is best, equal numbers are a tie). A ranking may leave conditions out.
    conditions : sequence of str
        All of them, in order.

    Raises
    ------
    InputError
        If a ranking places a condition twice.
    """
    if rankings.duplicated(["ranking", "condition"]).any():
        raise InputError("a ranking places a condition twice")
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
        return replace(unknown, reason="every ranking ties all that it places")
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
        situations=tuple(
            Situation(
                features=np.array([_features(chosen, len(names), sizes) for chosen in sets]),
                ways=np.eye(len(sets)),
            )
            for sets in choosable.values()
        ),
        kind=np.array([kinds[stage] for stage in stages], np.intp),
        cluster=pd.factorize(rankings["participant"])[0][rows],
        times=np.ones(len(stages), np.intp),
    )
    prior = np.hstack([centring(len(names)), np.zeros((len(names), len(sizes)))])
    fit = fit_choices(choices, prior if linked.swept else None)
    if not fit.converged:
        return replace(unknown, reason="the worths did not converge")
    segments = pd.factorize(rankings["segment"])[0][rows]
    return replace(
        unknown,
        **strength_fields(linked, fit, choices.kind, choices.cluster, segments),
        ties=dict(zip(sizes, fit.estimates[len(names) - 1 :].tolist(), strict=True)),
    )


def _stages(rankings: pd.DataFrame, names: Sequence[str]) -> tuple[list[Stage], NDArray[np.intp]]:
    """Return every choice of the next best, and a row of the ranking that it belongs to."""
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
    """Return how often the row's condition was placed before or beside the column's."""
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
    """Return the mean of the members' log worths, and which parameter of ties it has."""
    members = np.eye(count)[sorted(chosen)].mean(axis=0)[1:]
    return np.concatenate([members, [float(len(chosen) == size) for size in sizes]])
