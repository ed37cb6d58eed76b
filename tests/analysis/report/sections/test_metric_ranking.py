import math

import pytest

from analysis.report.sections.metric_table import first_and_second


@pytest.mark.parametrize(
    ("better", "best", "second"),
    [("lower", {1}, {0}), ("higher", {3}, {2}), ("near the reference", {2}, {0})],
)
def test_each_direction_has_its_own_best(better, best, second):
    assert first_and_second([3.0, 1.0, 5.0, 9.0], better, 4.9, 2) == (best, second)


def test_equal_scores_share_a_rank_as_far_as_they_are_printed():
    assert first_and_second([0.911, 0.912, 0.5, 0.4], "higher", math.nan, 2) == ({0, 1}, {2})


def test_missing_scores_have_no_rank():
    assert first_and_second([math.nan, 2.0, 3.0], "lower", math.nan, 2) == ({1}, {2})


@pytest.mark.parametrize("scores", [[1.0], [2.0, 2.0], [math.nan, math.nan], []])
def test_none_is_best_where_all_are_alike(scores):
    assert first_and_second(scores, "lower", math.nan, 2) == (frozenset(), frozenset())


def test_no_direction_and_unknown_recordings_rank_nothing():
    assert first_and_second([1.0, 2.0], "unsaid", 1.0, 2) == (frozenset(), frozenset())
    assert first_and_second([1.0, 2.0], "near the reference", math.nan, 2)[0] == frozenset()


def test_nearness_is_that_of_the_printed_numbers():
    found = first_and_second([30.6, 30.4, 0.0], "near the reference", 49.8, 0)
    assert found == ({0}, {1})
