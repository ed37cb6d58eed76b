"""Every metric against people's answers to every question."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from analysis.answers.table import AnswerTable
from analysis.metrics.scores import Better, StudyMetrics
from analysis.results.grouping import ByQuestion, by_question
from analysis.results.rank_correlations import (
    METHOD,
    RankCorrelation,
    SamplingRange,
    over_conditions,
    sampling_range,
)
from analysis.results.resamples import (
    PREFERENCE,
    RESAMPLES,
    OrientedMetric,
    ResampledPreferences,
    Tallies,
    oriented_metrics,
    resample_preferences,
    tally,
)
from analysis.stats.clustered_mean import Interval, t_quantile
from analysis.stats.samples import percentile_interval
from motion.arrays import Floats

SEED: Final = 0


FEWEST_SEGMENTS: Final = 6
"""With fewer, the variation of the correlation between segments is unknown."""

_ROUNDING: Final = 1e-9


@dataclass(frozen=True, kw_only=True)
class WithinCorrelation(Interval):
    """Pearson's correlation over single clips, after the mean of each condition is subtracted.

    The interval is clustered by segment.

    Attributes
    ----------
    cells, segments, answers : int
        Numbers of clips (pairs of clips for pairwise comparisons), segments and answers.
    """

    cells: int
    segments: int
    answers: int


@dataclass(frozen=True, kw_only=True)
class ScoredCondition:
    """The metric's score of a condition, and people's preference.

    Attributes
    ----------
    condition : str
        The condition's name.
    score : float
        The metric's score, as in the table of metrics, over the segments shown.
    preference, low, high : float
        People's preference for the condition, and the ends between which 95% of resamples lie.
    """

    condition: str
    score: float
    preference: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class MetricAgainstPeople:
    """The agreement of one metric with the answers to one question.

    Attributes
    ----------
    metric, unit : str
        The metric's name and unit.
    better : {'lower', 'higher', 'near the reference'}
        Which scores are better; this determines the sign of the correlations.
    recorded : float
        The score of recorded motion if nearness to it counts; NaN otherwise.
    conditions : int
        Number of conditions that are correlated.
    kendall, spearman : RankCorrelation
        Kendall's tau-b and Spearman's rho over the conditions.
    within : WithinCorrelation
        Over clips within conditions.
    places : tuple of ScoredCondition
        The conditions that are correlated.
    left_out : mapping of str to str
        Conditions that are not correlated, and why.
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
    """The agreement of all metrics with the answers to one question.

    Attributes
    ----------
    preference : str
        The measure of people's preference for a condition, in words.
    conditions, participants, segments : int
        Numbers of conditions that people judged, of participants and of segments.
    resamples : int
        Number of resamples of each interval.
    sampling_range : SamplingRange or None
        What a study with this number of conditions can find; None for fewer than three.
    metrics : tuple of MetricAgainstPeople
        In the order of the table of metrics; those without a better direction are left out.
    method : str
        How intervals were computed.
    reason : str
        Why there is nothing to compare; empty otherwise.
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
    """Compare all metrics with the answers, question by question.

    Parameters
    ----------
    table : AnswerTable
        The answers, of any protocol.
    analysed : DataFrame
        The analysed answers (`analysis.answers.participants.LeftOut`).
    metrics : StudyMetrics or None
        Automatic metrics by condition and clip; None if nothing was measured.
    recorded : str, optional
        The condition that is recorded motion.

    Returns
    -------
    ByQuestion of AgainstPeople
        Empty if there are no metrics.
    """
    if metrics is None or not metrics.conditions:
        return ByQuestion()
    # The matrices are small: more threads cost more than they save.
    with threadpool_limits(limits=1, user_api="blas"):
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
) -> AgainstPeople:
    """Compare all metrics with the answers to one question; see `metrics_against_people`."""
    tallies = tally(protocol, answers)
    preferences = resample_preferences(tallies, resamples=resamples, seed=SEED)
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
        metrics=tuple(_correlate(tallies, preferences, metric, too_few) for metric in metrics_of),
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
) -> MetricAgainstPeople:
    names, places = tallies.conditions, []
    for number in metric.present.tolist():
        draws = preferences.draws[:, number]
        draws = draws[~np.isnan(draws)]
        is_known = len(draws) and not too_few
        low, high = percentile_interval(draws) if is_known else (math.nan, math.nan)
        places.append(
            ScoredCondition(
                condition=names[number],
                score=float(metric.whole[number]),
                preference=float(preferences.estimates[number]),
                low=low,
                high=high,
            )
        )
    # A different seed from that of participants and segments.
    tau, rho = over_conditions(preferences, metric, too_few=too_few, seed=SEED + 1)
    return MetricAgainstPeople(
        metric=metric.name,
        unit=metric.unit,
        better=metric.better,
        recorded=metric.recorded,
        conditions=len(metric.present),
        kendall=tau,
        spearman=rho,
        within=within_conditions(tallies, metric),
        places=tuple(places),
        left_out={names[number]: why for number, why in metric.left_out.items()},
    )


def within_conditions(tallies: Tallies, metric: OrientedMetric) -> WithinCorrelation:
    """Correlate scores with mean answers over clips, after each group's mean is subtracted.

    A group is a condition or, for pairwise comparisons, a pair of conditions; there the difference
    of two scores is correlated with the win share. Clips are weighted by their number of answers.
    The interval is a jackknife over segments, whose clips share one speech (on Fisher's scale, t
    with segments - 1 degrees of freedom).

    Parameters
    ----------
    tallies : Tallies
        The answers.
    metric : OrientedMetric
        A metric of the same conditions and segments.
    """
    unknown = WithinCorrelation(cells=0, segments=0, answers=0)
    if metric.clips is None:
        return replace(unknown, reason="the metric scores whole conditions, not clips")
    if not len(metric.present):
        return replace(unknown, reason="no condition has a usable score")
    sums, answers = tallies.cells
    scores = _scores_of_groups(tallies, metric, metric.clips)
    usable = (answers > 0) & ~np.isnan(scores)
    # A group with one clip does not vary.
    usable &= (usable.sum(axis=1) > 1)[:, None]
    weights = np.where(usable, answers, 0)
    counted = WithinCorrelation(
        cells=int(usable.sum()),
        segments=int(usable.any(axis=0).sum()),
        answers=int(weights.sum()),
    )
    if counted.segments < 2:
        return replace(counted, reason="fewer than two segments have scores and answers")
    scores = np.where(usable, scores, 0)
    means = np.where(usable, sums / np.where(answers, answers, 1), 0)
    for values, name in ((scores, "scores"), (means, "answers")):
        if np.abs(_deviations(values, weights)).max() <= _ROUNDING * np.abs(values).max():
            return replace(counted, reason=f"the {name} do not differ within conditions")
    estimate = _correlation(scores, means, weights)
    others = ~np.eye(weights.shape[1], dtype=bool)[usable.any(axis=0)]
    without_each = np.array([_correlation(scores, means, weights * kept) for kept in others])
    low, high, reason = _interval(estimate, without_each)
    return replace(counted, estimate=estimate, low=low, high=high, reason=reason)


def _scores_of_groups(tallies: Tallies, metric: OrientedMetric, clips: Floats) -> Floats:
    """Return the oriented score of each group's clip, shape (G, segments); NaN if unknown."""
    oriented = metric.orient(clips, metric.recorded_clips).copy()
    oriented[list(metric.left_out)] = math.nan
    if tallies.groups.shape[1] == 1:
        return oriented[tallies.groups[:, 0]]
    return np.asarray(oriented[tallies.groups[:, 0]] - oriented[tallies.groups[:, 1]])


def _deviations(values: Floats, weights: Floats) -> Floats:
    """Return deviations of values from their group's mean, 0 for values without weight."""
    totals = weights.sum(axis=1, keepdims=True)
    means = (weights * values).sum(axis=1, keepdims=True) / np.where(totals, totals, 1)
    return np.where(weights > 0, values - means, 0)


def _correlation(first: Floats, second: Floats, weights: Floats) -> float:
    """Return the pooled correlation within groups; NaN if either does not vary."""
    x, y = _deviations(first, weights), _deviations(second, weights)
    spread = math.sqrt((weights * x**2).sum() * (weights * y**2).sum())
    return float((weights * x * y).sum()) / spread if spread else math.nan


def _interval(estimate: float, without_each: Floats) -> tuple[float, float, str]:
    count = len(without_each)
    if count < FEWEST_SEGMENTS:
        return math.nan, math.nan, f"{count} segments are too few for an interval"
    if np.isnan(without_each).any() or np.abs([estimate, *without_each]).max() > 1 - _ROUNDING:
        return math.nan, math.nan, "but for one segment, scores and answers lie on a line"
    z = np.arctanh(without_each)
    error = math.sqrt((count - 1) / count * float(np.square(z - z.mean()).sum()))
    margin = float(t_quantile(count - 1)) * error
    centre = math.atanh(estimate)
    return math.tanh(centre - margin), math.tanh(centre + margin), ""
