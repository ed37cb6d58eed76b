"""Scores of conditions, by name."""

from analysis.measurement.feature_scores import FeatureScores
from analysis.metrics.scores import ConditionScore, StudyMetrics


def score_of(metrics: StudyMetrics | FeatureScores, condition: str, name: str) -> ConditionScore:
    return next(s for s in metrics.conditions if (s.condition, s.name) == (condition, name))
