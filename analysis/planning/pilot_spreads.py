"""How much opinions differ, estimated from the answers of a pilot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from analysis.answers.table import AnswerTable
from analysis.planning.part import Opinions
from analysis.results.grouping import codes, compared, parts
from analysis.results.net_preference import (
    net_preference,
    sided,
)
from analysis.stats.ordinal.mixed_model import OrdinalFit, RandomEffect, fit
from motion.errors import InputError

MANY: Final = 10
"""More different ratings than these are those of a slider, and are taken in five bands."""


@dataclass(frozen=True, kw_only=True)
class Spreads:
    """What one model of a pilot's answers estimates.

    Attributes
    ----------
    participant_sd, item_sd : float
        Standard deviations of the difference of two conditions, in logits.
    thresholds : (float, float) or None
        From which felt difference on answers are slight, and clear; None where the scale does not
        tell.
    answers : int
        What it rests on.
    """

    participant_sd: float
    item_sd: float
    thresholds: tuple[float, float] | None
    answers: int


def pilot_opinions(table: AnswerTable, analysed: pd.DataFrame) -> tuple[Opinions, int]:
    """Return how people answer, pooled over all comparisons and questions, and from how many.

    Parameters
    ----------
    table : AnswerTable
        Of any protocol.
    analysed : DataFrame
        Its answers of those who are not excluded.

    Raises
    ------
    InputError
        If no model of the answers has an estimate.
    """
    with threadpool_limits(limits=1, user_api="blas"):
        found = list(_spreads(table, analysed))
    total = sum(one.answers for one in found)
    if not total:
        raise InputError(
            "the pilot's answers do not tell how much opinions differ",
            remedy="Take a pilot in which at least two participants answer about at least two "
            "segments, and not all alike; or leave --pilot away and state "
            "rehearsal.participants_differ and rehearsal.segments_differ in study.toml",
        )
    opinions = Opinions(
        participant_sd=_pooled([(one.participant_sd, one.answers) for one in found]),
        item_sd=_pooled([(one.item_sd, one.answers) for one in found]),
    )
    told = [(one.thresholds, one.answers) for one in found if one.thresholds is not None]
    if told:
        weights = [answers for _, answers in told]
        slight, clear = np.average([both for both, _ in told], axis=0, weights=weights).tolist()
        opinions = replace(opinions, slight=slight, clear=clear)
    return opinions, total


def _pooled(deviations: Sequence[tuple[float, int]]) -> float:
    """Return the root of the mean variance, by answers."""
    values, weights = zip(*deviations, strict=True)
    return math.sqrt(float(np.average(np.square(values), weights=weights)))


def _spreads(table: AnswerTable, analysed: pd.DataFrame) -> Iterator[Spreads]:
    of = {
        "pairwise": _of_preferences,
        "mismatch": _of_preferences,
        "rating": _of_ratings,
        "ranking": _of_rankings,
    }[table.protocol]
    for _, _, answers in parts(table, analysed):
        yield from of(answers)


def _of_preferences(answers: pd.DataFrame) -> Iterator[Spreads]:
    for _, rows in compared(answers):
        yield from _of_comparison(answers[rows])


def _of_comparison(answers: pd.DataFrame) -> Iterator[Spreads]:
    found = net_preference(sided(answers))
    if found.reason:
        return
    thresholds = None
    if found.answers_given == (1, 2, 3, 4, 5):
        lowest, low, high, highest = found.thresholds
        thresholds = ((high - low) / 2, (highest - lowest) / 2)
    yield Spreads(
        participant_sd=found.sd_participant,
        item_sd=found.sd_segment,
        thresholds=thresholds,
        answers=found.n,
    )


def _of_ratings(answers: pd.DataFrame) -> Iterator[Spreads]:
    """Fit conditions, and for participants and segments a level and a taste for each condition."""
    values = answers["value"].to_numpy(np.float64)
    given = np.unique(values)
    if len(given) > MANY:
        values = np.digitize(values, np.linspace(given[0], given[-1], 6)[1:-1])
    condition = codes(answers, "condition")
    shown = np.unique(condition)
    random = []
    for name in ("participant", "segment"):
        groups = codes(answers, name)
        taste = groups * (int(condition.max(initial=0)) + 1) + condition
        random += [
            RandomEffect(name=name, groups=groups),
            RandomEffect(name=f"{name}'s taste", groups=taste),
        ]
    covariates = {str(one): (condition == one).astype(float) for one in shown[1:]}
    found = _fitted(np.asarray(values, np.int64), covariates, random)
    if found is not None:
        yield Spreads(
            participant_sd=math.sqrt(2) * found.deviations["participant's taste"],
            item_sd=math.sqrt(2) * found.deviations["segment's taste"],
            thresholds=None,
            answers=len(answers),
        )


def _of_rankings(answers: pd.DataFrame) -> Iterator[Spreads]:
    """Fit who of every two conditions is placed before the other; ties tell nothing."""
    ranks = answers.pivot_table(
        index=["participant", "segment"], columns="condition", values="value", observed=True
    )
    for a, b in combinations(ranks.columns, 2):
        both = ranks[[a, b]].dropna()
        both = both[both[a] != both[b]]
        who, what = (both.index.get_level_values(n).to_numpy(object) for n in (0, 1))
        random = [
            RandomEffect(name="participant", groups=who.astype(str)),
            RandomEffect(name="segment", groups=what.astype(str)),
        ]
        found = _fitted((both[a] < both[b]).to_numpy().astype(np.int64), {}, random)
        if found is not None:
            yield Spreads(
                participant_sd=found.deviations["participant"],
                item_sd=found.deviations["segment"],
                thresholds=None,
                answers=len(both),
            )


def _fitted(
    values: NDArray[np.int64],
    covariates: dict[str, NDArray[np.float64]],
    random: Sequence[RandomEffect],
) -> OrdinalFit | None:
    """Return a model that converged; None where there is none."""
    if any(len(np.unique(effect.groups)) < 2 for effect in random):
        return None
    try:
        found = fit(values, covariates, random)
    except InputError:
        return None
    return found if found.converged else None
