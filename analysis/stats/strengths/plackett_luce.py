"""Plackett-Luce worths from rankings, whole or partial, with ties.

The best of the conditions still to be placed is chosen again and again, each with a probability
proportional to its worth. A tie is the choice of a set, whose weight is the geometric mean of its
members' worths times a parameter for ties of that size (Turner, van Etten, Firth & Kosmidis 2020).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.stats.strengths.choices import Choices, Situation, fit_choices
from analysis.stats.strengths.identified import links
from analysis.stats.strengths.two_way import ONE_PARTICIPANT, TwoWayErrors, deviations
from motion.errors import InputError

Floats = NDArray[np.float64]

Stage = tuple[frozenset[int], frozenset[int]]
"""The conditions still to be placed, and those placed next."""


@dataclass(frozen=True, kw_only=True)
class PlackettLuce:
    """Worths on the log scale; they add up to zero.

    Attributes
    ----------
    conditions : tuple of str
        In the order of everything else.
    worths : ndarray, shape (conditions,)
        Log worths; NaN where they are not identified.
    covariance : ndarray, shape (conditions, conditions)
        Clustered by participant (CR0).
    errors, errors_by_model : ndarray, shape (conditions,)
        Standard errors: clustered by participant; of the model.
    two_way : TwoWayErrors or None
        Errors clustered by participant and segment; None where segments are not known, or there
        is one of either.
    ties : mapping of int to float
        For each size of tie that occurs, the logarithm of its parameter.
    log_likelihood : float
        At the estimates.
    rankings, participants : int
        What it rests on.
    tiers, swept
        As of `BradleyTerry`.
    reason : str
        Why there are no worths; empty where there are. `remark` says why they have no errors.
    """

    conditions: tuple[str, ...]
    worths: Floats
    covariance: Floats
    errors: Floats
    errors_by_model: Floats
    two_way: TwoWayErrors | None
    ties: dict[int, float]
    log_likelihood: float
    rankings: int
    participants: int
    tiers: NDArray[np.intp]
    swept: str
    reason: str = ""

    @property
    def remark(self) -> str:
        """Why clustered errors are NaN although there are worths; empty where they are not."""
        return ONE_PARTICIPANT if self.participants < 2 and not self.reason else ""

    @property
    def errors_two_way(self) -> Floats:
        """Standard errors clustered by participant and segment; NaN where there are none."""
        none = np.full(len(self.conditions), math.nan)
        return none if self.two_way is None else self.two_way.errors


def plackett_luce(
    rankings: pd.DataFrame, *, conditions: Sequence[str] = (), cluster: str = "participant"
) -> PlackettLuce:
    """Fit worths to rankings.

    Parameters
    ----------
    rankings : DataFrame
        Columns `ranking` (names one ranking), `condition`, `rank` (1 is best, equal numbers are
        a tie) and the one named by `cluster`; `segment`, where two-way errors are wanted. A
        ranking may leave conditions out.
    conditions : sequence of str
        Their order; that of appearance unless given.
    cluster : str
        Rankings of one value of this column may depend on one another.

    Raises
    ------
    InputError
        If a ranking places a condition twice.
    """
    names = tuple(conditions) or tuple(dict.fromkeys(rankings["condition"]))
    if rankings.duplicated(["ranking", "condition"]).any():
        raise InputError("a ranking places a condition twice")
    made = _stages(rankings, names, cluster)
    stages, beats = made.stages, made.beats
    linked = links(beats, names)
    if reason := linked.apart if stages else "no rankings":
        return _unknown(names, rankings, made.people, reason)
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
        cluster=made.participants,
    )
    free = len(names) - 1
    turn = np.eye(len(names))[:, 1:] - 1 / len(names)
    prior = np.hstack([turn, np.zeros((len(names), len(sizes)))])
    fit = fit_choices(choices, prior if linked.swept else None)
    clustered = turn @ fit.clustered[:free, :free] @ turn.T
    by_model = turn @ fit.by_model[:free, :free] @ turn.T
    return PlackettLuce(
        conditions=names,
        worths=turn @ fit.estimates[:free],
        covariance=clustered,
        errors=deviations(clustered),
        errors_by_model=deviations(by_model),
        two_way=None
        if made.segments is None
        else TwoWayErrors.of(
            fit.influences[:, :free] @ turn.T,
            fit.situation,
            choices.kind,
            made.participants,
            made.segments,
        ),
        ties=dict(zip(sizes, fit.estimates[free:].tolist(), strict=True)),
        log_likelihood=fit.log_likelihood,
        rankings=int(rankings["ranking"].nunique()),
        participants=made.people,
        tiers=linked.tiers,
        swept=linked.swept,
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


def _stages(rankings: pd.DataFrame, names: Sequence[str], cluster: str) -> _Stages:
    number = {name: place for place, name in enumerate(names)}
    codes, people = pd.factorize(rankings[cluster])
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


def _unknown(
    names: tuple[str, ...],
    rankings: pd.DataFrame,
    people: int,
    reason: str,
) -> PlackettLuce:
    none = np.full(len(names), math.nan)
    return PlackettLuce(
        conditions=names,
        worths=none,
        covariance=np.full((len(names), len(names)), math.nan),
        errors=none,
        errors_by_model=none,
        two_way=None,
        ties={},
        log_likelihood=math.nan,
        rankings=int(rankings["ranking"].nunique()),
        participants=people,
        tiers=np.zeros(len(names), np.intp),
        swept="",
        reason=reason,
    )
