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

from analysis.strengths.choices import Choices, Situation, fit_choices
from analysis.strengths.identified import why_not_identified
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
    ties : mapping of int to float
        For each size of tie that occurs, the logarithm of its parameter.
    log_likelihood : float
        At the estimates.
    rankings, participants : int
        What it rests on.
    reason : str
        Why there are no worths; empty where there are.
    """

    conditions: tuple[str, ...]
    worths: Floats
    covariance: Floats
    errors: Floats
    errors_by_model: Floats
    ties: dict[int, float]
    log_likelihood: float
    rankings: int
    participants: int
    reason: str = ""


def plackett_luce(
    rankings: pd.DataFrame, *, conditions: Sequence[str] = (), cluster: str = "participant"
) -> PlackettLuce:
    """Fit worths to rankings.

    Parameters
    ----------
    rankings : DataFrame
        Columns `ranking` (names one ranking), `condition`, `rank` (1 is best, equal numbers are
        a tie) and the one named by `cluster`. A ranking may leave conditions out.
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
    stages, beats, people = _stages(rankings, names, cluster)
    reason = why_not_identified(beats, names) if stages else "no rankings"
    if reason:
        return _unknown(names, rankings, people, reason)
    sizes = sorted({len(chosen) for _, chosen in stages} - {1})
    left_over = list(dict.fromkeys(still for still, _ in stages))
    sets = {still: _choosable(still, sizes) for still in left_over}
    place = {still: number for number, still in enumerate(left_over)}
    fit = fit_choices(
        Choices(
            situations=tuple(
                Situation(
                    features=np.array([_features(s, len(names), sizes) for s in sets[still]]),
                    ways=np.eye(len(sets[still])),
                )
                for still in left_over
            ),
            situation=np.array([place[still] for still, _ in stages], np.intp),
            way=np.array([sets[still].index(chosen) for still, chosen in stages], np.intp),
            cluster=people[0],
        )
    )
    free = len(names) - 1
    turn = np.eye(len(names))[:, 1:] - 1 / len(names)
    clustered = turn @ fit.clustered[:free, :free] @ turn.T
    by_model = turn @ fit.by_model[:free, :free] @ turn.T
    return PlackettLuce(
        conditions=names,
        worths=turn @ fit.estimates[:free],
        covariance=clustered,
        errors=np.sqrt(np.diagonal(clustered)),
        errors_by_model=np.sqrt(np.diagonal(by_model)),
        ties=dict(zip(sizes, fit.estimates[free:].tolist(), strict=True)),
        log_likelihood=fit.log_likelihood,
        rankings=int(rankings["ranking"].nunique()),
        participants=people[1],
        reason="" if fit.converged else "the worths did not converge",
    )


def _stages(
    rankings: pd.DataFrame, names: Sequence[str], cluster: str
) -> tuple[list[Stage], Floats, tuple[NDArray[np.intp], int]]:
    """Return every choice of the next best, who beat whom, and whose choice it was."""
    number = {name: place for place, name in enumerate(names)}
    codes, people = pd.factorize(rankings[cluster])
    known = (rankings["ranking"].notna() & rankings["rank"].notna()).to_numpy()
    rankings, codes = rankings[known], codes[known]
    placed: dict[int, dict[float, list[int]]] = {}
    owner: dict[int, int] = {}
    for ranking, person, condition, rank in zip(
        pd.factorize(rankings["ranking"])[0].tolist(),
        codes.tolist(),
        rankings["condition"].map(number).tolist(),
        rankings["rank"].tolist(),
        strict=True,
    ):
        placed.setdefault(ranking, {}).setdefault(rank, []).append(condition)
        owner.setdefault(ranking, person)
    stages: list[Stage] = []
    owners: list[int] = []
    for ranking, by_rank in placed.items():
        levels = [frozenset(by_rank[rank]) for rank in sorted(by_rank)]
        still = frozenset[int]().union(*levels)
        for level in levels:
            if len(still) > 1:
                stages.append((still, level))
                owners.append(owner[ranking])
            still -= level
    beats = np.zeros((len(names), len(names)))
    for (still, level), count in Counter(stages).items():
        for better in level:
            beats[better, list(still - {better})] += count
    return stages, beats, (np.array(owners, np.intp), len(people))


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
    people: tuple[NDArray[np.intp], int],
    reason: str,
) -> PlackettLuce:
    none = np.full(len(names), math.nan)
    return PlackettLuce(
        conditions=names,
        worths=none,
        covariance=np.full((len(names), len(names)), math.nan),
        errors=none,
        errors_by_model=none,
        ties={},
        log_likelihood=math.nan,
        rankings=int(rankings["ranking"].nunique()),
        participants=people[1],
        reason=reason,
    )
