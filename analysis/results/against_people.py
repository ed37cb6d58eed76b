"""Every metric beside the answers to every question."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd

from analysis.answers.table import AnswerTable
from analysis.measurement.scores import StudyMetrics
from analysis.metrics.result import Better
from analysis.results.drawn_preferences import (
    PREFERENCE,
    RESAMPLES,
    DrawnPreferences,
    Tallies,
    drawn_preferences,
    tallies,
)
from analysis.results.grouping import ByQuestion, by_question
from analysis.results.metric_scores import (
    MetricSide,
    WithinCorrelation,
    metric_sides,
    within_conditions,
)
from analysis.results.rank_correlations import (
    METHOD,
    RankCorrelation,
    SamplingRange,
    over_conditions,
    sampling_range,
)

SEED: Final = 0


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a condition stands in the metric and in people's preference.

    Attributes
    ----------
    condition : str
        Which one.
    score : float
        What the metric says of it, as in the table of metrics, over the segments shown.
    preference, low, high : float
        How much people prefer it, and the ends between which 95% of resamples lie.
    """

    condition: str
    score: float
    preference: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class MetricAgainstPeople:
    """One metric beside the answers to one question.

    Attributes
    ----------
    metric, unit : str
        What was measured.
    better : {'lower', 'higher', 'near the reference'}
        Which scores speak for a condition; it gives the correlations their sign.
    recorded : float
        The score of recorded motion where nearness to it is what counts; NaN otherwise.
    conditions : int
        How many are correlated.
    kendall, spearman : RankCorrelation
        Kendall's tau-b and Spearman's rho over the conditions.
    within : WithinCorrelation
        Over clips within conditions.
    places : tuple of Place
        The conditions that are correlated.
    left_out : mapping of str to str
        Conditions that are not, and why.
    """

    metric: str
    unit: str
    better: Better
    recorded: float
    conditions: int
    kendall: RankCorrelation
    spearman: RankCorrelation
    within: WithinCorrelation
    places: tuple[Place, ...]
    left_out: Mapping[str, str]


@dataclass(frozen=True, kw_only=True)
class AgainstPeople:
    """All metrics beside the answers to one question.

    Attributes
    ----------
    preference : str
        What stands for people's preference of a condition, in words.
    conditions, participants, segments : int
        Conditions that people judged, and what the judgement rests on.
    resamples : int
        How many intervals rest on.
    sampling_range : SamplingRange or None
        What so many conditions can show at all; None for fewer than three.
    metrics : tuple of MetricAgainstPeople
        In the order of the table of metrics; those that call no direction better are left out.
    method : str
        How intervals were found.
    reason : str
        Why there is nothing to compare; empty where there is something.
    """

    preference: str
    conditions: int
    participants: int
    segments: int
    resamples: int
    sampling_range: SamplingRange | None
    metrics: tuple[MetricAgainstPeople, ...]
    method: str
    reason: str = ""


def metrics_against_people(
    table: AnswerTable,
    analysed: pd.DataFrame,
    metrics: StudyMetrics | None,
    recorded: str | None = None,
) -> ByQuestion[AgainstPeople]:
    """Set all metrics beside the answers, question by question.

    Parameters
    ----------
    table : AnswerTable
        The answers, of any protocol.
    analysed : DataFrame
        Those of them that are analysed (`analysis.answers.participants.LeftOut`).
    metrics : StudyMetrics or None
        Automatic metrics by condition and clip; None where nothing was measured.
    recorded : str, optional
        The condition that is recorded motion.

    Returns
    -------
    ByQuestion of AgainstPeople
        Empty where there are no metrics.
    """
    if metrics is None or not metrics.conditions:
        return ByQuestion()
    return by_question(
        table,
        analysed,
        lambda answers: against_people(table.protocol, answers, metrics, recorded),
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
