"""Every metric beside the answers to every question."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import pandas as pd

from analysis.answers.table import AnswerTable
from analysis.measurement.scores import StudyMetrics
from analysis.results.against_people.metric_side import MetricSide, metric_sides
from analysis.results.against_people.over_conditions import METHOD, over_conditions, sampling_range
from analysis.results.against_people.people_side import (
    PREFERENCE,
    RESAMPLES,
    DrawnPreferences,
    Tallies,
    drawn_preferences,
    tallies,
)
from analysis.results.against_people.result import AgainstPeople, MetricAgainstPeople, Place
from analysis.results.against_people.within_conditions import within_conditions
from analysis.results.grouping import ByQuestion, by_question

SEED: Final = 0


def metrics_against_people(
    table: AnswerTable,
    analysed: pd.DataFrame,
    metrics: StudyMetrics | None,
    recorded: str | None = None,
    *,
    resamples: int = RESAMPLES,
    seed: int = SEED,
) -> ByQuestion[AgainstPeople]:
    """Set all metrics beside the answers, question by question.

    Parameters
    ----------
    table : AnswerTable
        The answers, of any protocol.
    analysed : DataFrame
        Those of them that are analysed (`analysis.results.participants.LeftOut`).
    metrics : StudyMetrics or None
        Automatic metrics by condition and clip; None where nothing was measured.
    recorded : str, optional
        The condition that is recorded motion.
    resamples : int
        How many to draw.
    seed : int
        The same seed gives the same resamples.

    Returns
    -------
    ByQuestion of AgainstPeople
        Empty where there are no metrics.
    """
    if metrics is None or not metrics.conditions:
        return {}
    return by_question(
        table,
        analysed,
        lambda answers: against_people(
            table.protocol, answers, metrics, recorded, resamples=resamples, seed=seed
        ),
    )


def against_people(
    protocol: str,
    answers: pd.DataFrame,
    metrics: StudyMetrics,
    recorded: str | None = None,
    *,
    resamples: int = RESAMPLES,
    seed: int = SEED,
) -> AgainstPeople:
    """Set all metrics beside the answers to one question; see `metrics_against_people`."""
    found = tallies(protocol, answers)
    preferences = drawn_preferences(found, resamples=resamples, seed=seed)
    sides = metric_sides(metrics, found.conditions, found.segments, recorded)
    too_few = _too_few(found)
    count = len(found.conditions)
    return AgainstPeople(
        preference=PREFERENCE[protocol],
        conditions=count,
        participants=found.participants,
        segments=len(found.segments),
        resamples=resamples,
        sampling_range=sampling_range(count) if count > 2 else None,
        metrics=tuple(_beside(found, preferences, side, too_few, seed) for side in sides),
        method=METHOD,
        reason="" if sides else "no metric says which of its scores speak for a condition",
    )


def _too_few(found: Tallies) -> str:
    if found.participants < 2:
        return "one participant: nothing tells how people differ"
    if len(found.segments) < 2:
        return "one segment: nothing tells how segments differ"
    return ""


def _beside(
    found: Tallies, preferences: DrawnPreferences, side: MetricSide, too_few: str, seed: int
) -> MetricAgainstPeople:
    names = found.conditions
    # Other resamples of conditions than those of people and segments.
    tau, rho = over_conditions(preferences, side, too_few=too_few, seed=seed + 1)
    return MetricAgainstPeople(
        metric=side.name,
        unit=side.unit,
        better=side.better,
        recorded=side.recorded,
        conditions=len(side.present),
        kendall=tau,
        spearman=rho,
        within=within_conditions(found, side),
        places=tuple(
            _place(names[place], float(side.whole[place]), place, preferences, too_few)
            for place in side.present.tolist()
        ),
        left_out={names[place]: why for place, why in side.left_out.items()},
    )


def _place(
    name: str, score: float, place: int, preferences: DrawnPreferences, too_few: str
) -> Place:
    draws = preferences.draws[:, place]
    draws = draws[~np.isnan(draws)]
    low, high = math.nan, math.nan
    if len(draws) and not too_few:
        low, high = map(float, np.quantile(draws, [0.025, 0.975]))
    return Place(
        condition=name,
        score=score,
        preference=float(preferences.estimates[place]),
        low=low,
        high=high,
    )
