"""How much opinions differ, estimated from the answers of a pilot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from analysis.answers.table import AnswerTable
from analysis.planning.part import Opinions
from analysis.results.grouping import codes, split_by_key, split_by_question
from analysis.results.mixed_models import net_preference, sided
from analysis.stats.ordinal.mixed_model import OrdinalFit, RandomEffect, fit
from motion.arrays import Floats, Ints
from motion.errors import InputError

MANY: Final = 10
"""More distinct ratings than this come from a slider, and are grouped into five bands."""


@dataclass(frozen=True, kw_only=True)
class Spreads:
    """The estimates of one model of a pilot's answers.

    Attributes
    ----------
    participant_sd, item_sd : float
        Standard deviations of the difference of two conditions, in logits.
    thresholds : (float, float) or None
        Latent differences from which answers are slight, and clear; None if the scale does not show
        them.
    answers : int
        Number of answers in the model.
    """

    participant_sd: float
    item_sd: float
    answers: int
    thresholds: tuple[float, float] | None = None


def pilot_opinions(table: AnswerTable, analysed: pd.DataFrame) -> tuple[Opinions, int]:
    """Return opinions pooled over all comparisons and questions, and the number of answers.

    Parameters
    ----------
    table : AnswerTable
        The answers, of any protocol.
    analysed : DataFrame
        The answers of participants who are not excluded.

    Raises
    ------
    InputError
        If no model of the answers has an estimate.
    """
    with threadpool_limits(limits=1, user_api="blas"):
        spreads = list(_spreads(table, analysed))
    total = sum(spread.answers for spread in spreads)
    if not total:
        raise InputError(
            "the pilot's answers do not show how much opinions differ",
            remedy="Use a pilot in which at least two participants judge at least two segments, "
            "and not all answers agree; or omit --pilot and state "
            "rehearsal.participants_differ and rehearsal.segments_differ in study.toml",
        )
    # The roots of the mean variances, by answers.
    variances = [(spread.participant_sd**2, spread.item_sd**2) for spread in spreads]
    weights = [spread.answers for spread in spreads]
    participant_sd, item_sd = np.sqrt(np.average(variances, axis=0, weights=weights)).tolist()
    opinions = Opinions(participant_sd=participant_sd, item_sd=item_sd)
    graded = [spread for spread in spreads if spread.thresholds is not None]
    if graded:
        slight, clear = np.average(
            [spread.thresholds for spread in graded],
            axis=0,
            weights=[spread.answers for spread in graded],
        ).tolist()
        opinions = replace(opinions, slight=slight, clear=clear)
    return opinions, total


def _spreads(table: AnswerTable, analysed: pd.DataFrame) -> Iterator[Spreads]:
    if table.protocol in ("pairwise", "mismatch"):
        for _, answers in split_by_key(table, analysed):
            yield from _of_comparison(answers)
        return
    of_question = _of_ratings if table.protocol == "rating" else _of_rankings
    for _, _, answers in split_by_question(table, analysed):
        yield from of_question(answers)


def _of_comparison(answers: pd.DataFrame) -> Iterator[Spreads]:
    net = net_preference(sided(answers))
    if net.reason:
        return
    thresholds = None
    if net.answers_given == (1, 2, 3, 4, 5):
        lowest, low, high, highest = net.thresholds
        thresholds = ((high - low) / 2, (highest - lowest) / 2)
    yield Spreads(
        participant_sd=net.sd_participant,
        item_sd=net.sd_segment,
        thresholds=thresholds,
        answers=net.n,
    )


def _of_ratings(answers: pd.DataFrame) -> Iterator[Spreads]:
    """Fit conditions, with a level and a taste per condition of each participant and segment."""
    values = answers["value"].to_numpy(np.float64)
    scores = np.unique(values)
    if len(scores) > MANY:
        values = np.digitize(values, np.linspace(scores[0], scores[-1], 6)[1:-1])
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
    covariates = {str(code): (condition == code).astype(float) for code in shown[1:]}
    model = _converged_fit(np.asarray(values, np.int64), covariates, random)
    if model is not None:
        yield Spreads(
            participant_sd=math.sqrt(2) * model.deviations["participant's taste"],
            item_sd=math.sqrt(2) * model.deviations["segment's taste"],
            answers=len(answers),
        )


def _of_rankings(answers: pd.DataFrame) -> Iterator[Spreads]:
    """Fit which condition of each pair is placed first; ties are dropped."""
    ranks = answers.pivot_table(
        index=["participant", "segment"], columns="condition", values="value", observed=True
    )
    for a, b in combinations(ranks.columns, 2):
        both = ranks[[a, b]].dropna()
        both = both[both[a] != both[b]]
        random = [
            RandomEffect(name=name, groups=both.index.get_level_values(name).to_numpy(str))
            for name in ("participant", "segment")
        ]
        model = _converged_fit((both[a] < both[b]).to_numpy().astype(np.int64), {}, random)
        if model is not None:
            yield Spreads(
                participant_sd=model.deviations["participant"],
                item_sd=model.deviations["segment"],
                answers=len(both),
            )


def _converged_fit(
    values: Ints, covariates: dict[str, Floats], random: Sequence[RandomEffect]
) -> OrdinalFit | None:
    if any(len(np.unique(effect.groups)) < 2 for effect in random):
        return None
    try:
        model = fit(values, covariates, random)
    except InputError:
        return None
    return model if model.converged else None
