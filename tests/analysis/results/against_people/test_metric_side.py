import math

import numpy as np
import pytest

from analysis.measurement.scores import ConditionScore, StudyMetrics
from analysis.results.against_people.metric_side import ITSELF, NOTHING_RECORDED, metric_sides
from tests.analysis.results.against_people.simulated_studies import metrics_of

SCORES = np.array([[1.0, 3.0], [4.0, 6.0], [math.nan, 2.0]])
NAMES = ("c00", "c01", "c02")
SEGMENTS = ("s00", "s01")


@pytest.mark.parametrize(
    ("better", "spoken"),
    [("higher", [2.0, 5.0, 2.0]), ("lower", [-2.0, -5.0, -2.0]), ("near the reference", [3, 3])],
)
def test_more_always_speaks_for_a_condition(better, spoken):
    (found,) = metric_sides(metrics_of(SCORES, better=better), NAMES, SEGMENTS, "c01")
    assert found.drawn(np.ones((1, 2)))[0] == pytest.approx(
        np.abs(spoken) * np.sign(spoken[0]) * (-1 if better == "near the reference" else 1)
    )


def test_recorded_motion_is_not_correlated_where_nearness_to_it_counts():
    (found,) = metric_sides(metrics_of(SCORES, better="near the reference"), NAMES, SEGMENTS, "c01")
    assert found.left_out == {1: ITSELF}
    assert found.recorded == 5


def test_without_recorded_motion_nothing_is_near_to_it():
    metrics = metrics_of(SCORES, better="near the reference")
    (found,) = metric_sides(metrics, NAMES, SEGMENTS, None)
    assert set(found.left_out.values()) == {NOTHING_RECORDED}


def test_scores_of_a_resample_are_means_over_the_segments_drawn():
    (found,) = metric_sides(metrics_of(SCORES), NAMES, SEGMENTS, None)
    drawn = found.drawn(np.array([[2.0, 0.0], [0.0, 2.0]]))
    assert drawn[1] == pytest.approx([3, 6, 2])
    assert drawn[0, :2] == pytest.approx([1, 4])
    assert math.isnan(drawn[0, 2])


def test_a_condition_without_a_score_says_why():
    scores = np.array([[1.0, 3.0], [math.nan, math.nan]])
    (found,) = metric_sides(metrics_of(scores), NAMES, SEGMENTS, None)
    assert found.left_out == {1: "too short (2 of 2 clips)", 2: "the metric was not measured"}


def test_scores_that_call_nothing_better_are_not_among_them():
    assert metric_sides(metrics_of(SCORES, better="unsaid"), NAMES, SEGMENTS, None) == ()


def test_a_score_of_whole_conditions_stays_in_every_resample():
    whole = tuple(
        ConditionScore(
            condition=name,
            name="FGD",
            unit="",
            value=value,
            spread=math.nan,
            scored=2,
            clips=2,
            settings={},
            reason="",
            better="lower",
        )
        for name, value in (("c00", 3.0), ("c01", 1.0))
    )
    metrics = StudyMetrics(frame_rate=30.0, clips=(), conditions=whole)
    (found,) = metric_sides(metrics, NAMES[:2], SEGMENTS, None)
    assert found.drawn(np.array([[2.0, 0.0], [0.0, 2.0]])).tolist() == [[-3, -1], [-3, -1]]
