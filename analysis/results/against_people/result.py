"""How automatic metrics agree with people, as `results.json` holds it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from analysis.metrics.result import Better


@dataclass(frozen=True, kw_only=True)
class RankCorrelation:
    """A rank correlation over conditions, with an interval.

    Attributes
    ----------
    estimate, low, high : float
        In [-1, 1]; above zero where the metric and people agree. NaN where there is none.
    degenerate : int
        Resamples without a correlation, which the interval leaves out.
    reason : str
        Why the estimate or its interval is missing; empty where both are there.
    """

    estimate: float
    low: float
    high: float
    degenerate: int = 0
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class WithinCorrelation:
    """The correlation over single clips, each measured from the mean of its condition.

    Attributes
    ----------
    estimate, low, high : float
        Pearson's, in [-1, 1], with a 95 % interval clustered by segment; NaN where there is none.
    cells, segments, answers : int
        Clips (of pairwise comparisons, pairs of clips), segments and answers that it rests on.
    reason : str
        Why the estimate or its interval is missing; empty where both are there.
    """

    estimate: float
    low: float
    high: float
    cells: int
    segments: int
    answers: int
    reason: str = ""


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
        How much people prefer it, and the ends between which 95 % of resamples lie.
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
class SamplingRange:
    """What a study without any other error would show of a correlation of `tau`.

    Attributes
    ----------
    tau : float
        Kendall's tau among all conditions such as these.
    low, high : float
        Ends between which 95 % of studies with `conditions` conditions find it.
    conditions : int
        How many conditions a study has.
    """

    tau: float
    low: float
    high: float
    conditions: int


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
