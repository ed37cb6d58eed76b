"""Scores of conditions and of their clips, by name."""

from analysis.measurement.feature_scores import FeatureScores
from analysis.metrics.scores import ConditionScore, StudyMetrics


def clip_scores(metrics: StudyMetrics, condition: str, name: str) -> dict[str, float]:
    """Return the scores of a condition's clips by segment."""
    own = [s for s in metrics.clips if (s.condition, s.result.name) == (condition, name)]
    return {score.segment: score.result.value for score in own}


def score_of(metrics: StudyMetrics | FeatureScores, condition: str, name: str) -> ConditionScore:
    return next(s for s in metrics.conditions if (s.condition, s.name) == (condition, name))
