"""Every metric against people's answers to every question."""

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
from analysis.results.grouping import ByQuestion, by_question
from analysis.results.metric_scores import (
    OrientedMetric,
    WithinCorrelation,
    oriented_metrics,
    within_conditions,
)
from analysis.results.rank_correlations import (
    METHOD,
    RankCorrelation,
    SamplingRange,
    over_conditions,
    sampling_range,
)
from analysis.results.resampled_preferences import (
    PREFERENCE,
    RESAMPLES,
    ResampledPreferences,
    Tallies,
    resample_preferences,
    tally,
)
from analysis.stats.samples import percentile_interval

SEED: Final = 0


@dataclass(frozen=True, kw_only=True)
class ScoredCondition:
    """The metric's score of a condition, and people's preference.

    Attributes
    ----------
    condition : str
        Its name.
    score : float
        The metric's score, as in the table of metrics, over the segments shown.
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
        Which scores are better; it gives the correlations their sign.
    recorded : float
        The score of recorded motion where nearness to it is what counts; NaN otherwise.
    conditions : int
        How many are correlated.
    kendall, spearman : RankCorrelation
        Kendall's tau-b and Spearman's rho over the conditions.
    within : WithinCorrelation
        Over clips within conditions.
    places : tuple of ScoredCondition
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
    places: tuple[ScoredCondition, ...]
    left_out: Mapping[str, str]


@dataclass(frozen=True, kw_only=True)
class AgainstPeople:
    """All metrics beside the answers to one question.

    Attributes
    ----------
    preference : str
        The measure of people's preference of a condition, in words.
    conditions, participants, segments : int
        Conditions that people judged, and what the judgement rests on.
    resamples : int
        Of each interval.
    sampling_range : SamplingRange or None
        What a study with so many conditions can find; None for fewer than three.
    metrics : tuple of MetricAgainstPeople
        In the order of the table of metrics; those without a better direction are left out.
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
    tallies = tally(protocol, answers)
    preferences = resample_preferences(tallies, resamples=resamples, seed=seed)
    metrics_of = oriented_metrics(metrics, tallies.conditions, tallies.segments, recorded)
    too_few = _too_few(tallies)
    count = len(tallies.conditions)
    return AgainstPeople(
        preference=PREFERENCE[protocol],
        conditions=count,
        participants=tallies.participants,
        segments=len(tallies.segments),
        resamples=resamples,
        sampling_range=sampling_range(count) if count > 2 else None,
        metrics=tuple(
            _correlate(tallies, preferences, metric, too_few, seed) for metric in metrics_of
        ),
        method=METHOD,
        reason="" if metrics_of else "no metric says which of its scores are better",
    )


def _too_few(tallies: Tallies) -> str:
    if tallies.participants < 2:
        return "one participant: it is unknown how people differ"
    if len(tallies.segments) < 2:
        return "one segment: it is unknown how segments differ"
    return ""


def _correlate(
    tallies: Tallies,
    preferences: ResampledPreferences,
    metric: OrientedMetric,
    too_few: str,
    seed: int,
) -> MetricAgainstPeople:
    names = tallies.conditions
    # Other resamples of conditions than those of people and segments.
    tau, rho = over_conditions(preferences, metric, too_few=too_few, seed=seed + 1)
    return MetricAgainstPeople(
        metric=metric.name,
        unit=metric.unit,
        better=metric.better,
        recorded=metric.recorded,
        conditions=len(metric.present),
        kendall=tau,
        spearman=rho,
        within=within_conditions(tallies, metric),
        places=tuple(
            _scored(names[number], float(metric.whole[number]), number, preferences, too_few)
            for number in metric.present.tolist()
        ),
        left_out={names[number]: why for number, why in metric.left_out.items()},
    )


def _scored(
    name: str, score: float, number: int, preferences: ResampledPreferences, too_few: str
) -> ScoredCondition:
    draws = preferences.draws[:, number]
    draws = draws[~np.isnan(draws)]
    low, high = math.nan, math.nan
    if len(draws) and not too_few:
        low, high = percentile_interval(draws)
    return ScoredCondition(
        condition=name,
        score=score,
        preference=float(preferences.estimates[number]),
        low=low,
        high=high,
    )
