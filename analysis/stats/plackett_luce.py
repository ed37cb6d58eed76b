"""Plackett-Luce worths from rankings, whole or partial, with ties.

The best of the conditions still to be placed is chosen again and again, each with a probability
proportional to its worth. A tie is the choice of a set, whose weight is the geometric mean of its
members' worths times a parameter for ties of that size (Turner, van Etten, Firth & Kosmidis 2020).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.stats.choices import Choices, Situation, fit_choices
from analysis.stats.strengths import Strengths, centring, fitted, links, unknown
from motion.errors import InputError

Floats = NDArray[np.float64]

Stage = tuple[frozenset[int], frozenset[int]]
"""The conditions still to be placed, and those placed next."""


@dataclass(frozen=True, kw_only=True)
class PlackettLuce(Strengths):
    """Worths of conditions that were ranked.

    Attributes
    ----------
    ties : mapping of int to float
        For each size of tie that occurs, the logarithm of its parameter.
    """

    ties: dict[int, float] = field(default_factory=dict)


def plackett_luce(rankings: pd.DataFrame, *, conditions: Sequence[str] = ()) -> PlackettLuce:
    """Fit worths to rankings.

    Parameters
    ----------
    rankings : DataFrame
        Columns `ranking` (names one ranking), `participant`, `condition` and `rank` (1 is best,
        equal numbers are a tie); `segment`, where two-way errors are wanted. A ranking may leave
        conditions out.
    conditions : sequence of str
        Their order; that of appearance unless given.

    Raises
    ------
    InputError
        If a ranking places a condition twice.
    """
    names = tuple(conditions) or tuple(dict.fromkeys(rankings["condition"]))
    if rankings.duplicated(["ranking", "condition"]).any():
        raise InputError("a ranking places a condition twice")
    given = _stages(rankings, names)
    stages = given.stages
    linked = links(given.beats, names)
    count = int(rankings["ranking"].nunique())
    if reason := linked.apart if stages else "no rankings":
        return PlackettLuce(
            conditions=names,
            **unknown(len(names)),
            n=count,
            participants=given.people,
            reason=reason,
        )
    sizes = sorted({len(chosen) for _, chosen in stages} - {1})
    left_over = list(dict.fromkeys(still for still, _ in stages))
    sets = {still: _choosable(still, sizes) for still in left_over}
    place = {still: number for number, still in enumerate(left_over)}
    choices = Choices(
        situations=tuple(
            Situation(
                features=np.array([_features(s, len(names), sizes) for s in sets[still]]),
                ways=np.eye(len(sets[still])),
            )
            for still in left_over
        ),
        situation=np.array([place[still] for still, _ in stages], np.intp),
        way=np.array([sets[still].index(chosen) for still, chosen in stages], np.intp),
        cluster=given.participants,
    )
    prior = np.hstack([centring(len(names)), np.zeros((len(names), len(sizes)))])
    fit = fit_choices(choices, prior if linked.swept else None)
    of_ties = fit.estimates[len(names) - 1 :].tolist()
    return PlackettLuce(
        conditions=names,
        **fitted(linked, fit, choices.kind, given.participants, given.segments),
        n=count,
        participants=given.people,
        ties=dict(zip(sizes, of_ties, strict=True)),
        reason="" if fit.converged else "the worths did not converge",
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Stages:
    """Every choice of the next best.

    Attributes
    ----------
    stages : list of Stage
        What was chosen of what.
    participants, segments : ndarray of int, shape (stages,)
        Whose choice it was, and about which segment; None where segments are not known.
    beats : ndarray, shape (conditions, conditions)
        How often the row's condition was placed before or beside the column's.
    people : int
        How many gave rankings.
    """

    stages: list[Stage]
    participants: NDArray[np.intp]
    segments: NDArray[np.intp] | None
    beats: Floats
    people: int


def _stages(rankings: pd.DataFrame, names: Sequence[str]) -> _Stages:
    number = {name: place for place, name in enumerate(names)}
    codes, people = pd.factorize(rankings["participant"])
    known = (rankings["ranking"].notna() & rankings["rank"].notna()).to_numpy()
    rankings, codes = rankings[known], codes[known]
    placed: dict[int, dict[float, list[int]]] = {}
    ranking_of = pd.factorize(rankings["ranking"])[0]
    for ranking, condition, rank in zip(
        ranking_of.tolist(),
        rankings["condition"].map(number).tolist(),
        rankings["rank"].tolist(),
        strict=True,
    ):
        placed.setdefault(ranking, {}).setdefault(rank, []).append(condition)
    stages: list[Stage] = []
    owners: list[int] = []
    for ranking, by_rank in placed.items():
        levels = [frozenset(by_rank[rank]) for rank in sorted(by_rank)]
        still = frozenset[int]().union(*levels)
        for level in levels:
            if len(still) > 1:
                stages.append((still, level))
                owners.append(ranking)
            still -= level
    beats = np.zeros((len(names), len(names)))
    for (still, level), count in Counter(stages).items():
        for better in level:
            beats[better, list(still - {better})] += count
    # The row in which each choice's ranking begins.
    rows = np.unique(ranking_of, return_index=True)[1][np.array(owners, np.intp)]
    things = pd.factorize(rankings["segment"])[0] if "segment" in rankings else None
    return _Stages(
        stages=stages,
        participants=codes[rows],
        segments=None if things is None else things[rows],
        beats=beats,
        people=len(people),
    )


def _choosable(still: frozenset[int], sizes: Sequence[int]) -> list[frozenset[int]]:
    """Return all sets that can be placed next."""
    return [
        frozenset(chosen)
        for size in (1, *sizes)
        if size <= len(still)
        for chosen in combinations(sorted(still), size)
    ]


def _features(chosen: frozenset[int], count: int, sizes: Sequence[int]) -> Floats:
    """Return the mean of the members' log worths, and which parameter of ties it has."""
    members = np.eye(count)[sorted(chosen)].mean(axis=0)[1:]
    return np.concatenate([members, [float(len(chosen) == size) for size in sizes]])
