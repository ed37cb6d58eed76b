import math

import numpy as np
import pandas as pd
import pytest

from analysis.measurement.scores import StudyMetrics
from analysis.results.against_people.metric_side import metric_sides
from analysis.results.against_people.people_side import tallies
from analysis.results.against_people.result import WithinCorrelation
from analysis.results.against_people.within_conditions import within_conditions
from tests.analysis.results.against_people.simulated_studies import AgreeingStudy, metrics_of, names


def _within(answers: pd.DataFrame, metrics: StudyMetrics) -> WithinCorrelation:
    found = tallies("rating", answers)
    (side,) = metric_sides(metrics, found.conditions, found.segments, None)
    return within_conditions(found, side)


def test_it_is_the_correlation_of_what_is_left_when_condition_means_are_taken_off():
    answers, metrics = AgreeingStudy(within=0.6).drawn(np.random.default_rng(1))
    found = _within(answers, metrics)
    rows = answers.groupby(["condition", "segment"], observed=True)["value"].mean().reset_index()
    rows["score"] = [clip.result.value for clip in metrics.clips]
    rows["value"] -= rows.groupby("condition", observed=True)["value"].transform("mean")
    rows["score"] -= rows.groupby("condition", observed=True)["score"].transform("mean")
    assert found.estimate == pytest.approx(rows["value"].corr(rows["score"]))
    assert found.low < found.estimate < found.high
    assert (found.cells, found.segments, found.answers) == (72, 12, 1440)


def test_differences_between_conditions_do_not_enter():
    answers, metrics = AgreeingStudy(within=0.3).drawn(np.random.default_rng(2))
    moved = answers.assign(value=answers["value"] + 5.0 * answers["condition"].cat.codes)
    assert _within(moved, metrics).estimate == pytest.approx(_within(answers, metrics).estimate)


def test_of_pairs_it_sets_the_difference_of_scores_beside_the_win_share():
    chance = np.random.default_rng(5)
    scores = chance.normal(size=(2, 10))
    wins = scores[0] - scores[1] > np.median(scores[0] - scores[1])
    codes = np.arange(10)
    answers = pd.DataFrame(
        {
            "participant": pd.Categorical(["p"] * 10),
            "segment": pd.Categorical.from_codes(codes, names("s", 10)),
            "left": pd.Categorical.from_codes(np.zeros(10, int), names("c", 2)),
            "right": pd.Categorical.from_codes(np.ones(10, int), names("c", 2)),
            "value": np.where(wins, 1, 5),
        }
    )
    found = tallies("pairwise", answers)
    (side,) = metric_sides(metrics_of(scores), found.conditions, found.segments, None)
    expected = np.corrcoef(scores[0] - scores[1], wins)[0, 1]
    assert within_conditions(found, side).estimate == pytest.approx(expected)


def test_few_segments_give_an_estimate_without_interval():
    answers, metrics = AgreeingStudy(segments=4).drawn(np.random.default_rng(1))
    found = _within(answers, metrics)
    assert not math.isnan(found.estimate)
    assert math.isnan(found.low)
    assert found.reason == "4 segments are too few for an interval"


def test_what_does_not_differ_is_named():
    answers, metrics = AgreeingStudy().drawn(np.random.default_rng(1))
    assert "answers do not differ" in _within(answers.assign(value=0.1), metrics).reason
    alike = metrics_of(np.full((6, 12), 0.1))
    assert "scores do not differ" in _within(answers, alike).reason


def test_one_segment_has_nothing_to_correlate():
    answers, metrics = AgreeingStudy(segments=1).drawn(np.random.default_rng(1))
    found = _within(answers, metrics)
    assert math.isnan(found.estimate)
    assert "fewer than two segments" in found.reason
