from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.clustered_variance import ONE_SEGMENT
from analysis.stats.heterogeneity import cells


def made() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    chance = np.random.default_rng(2)
    who, what = np.repeat(np.arange(9), 12), np.tile(np.arange(12), 9)
    return chance.integers(0, 3, len(who)) / 2, who, what


def test_a_level_of_many_segments_is_tested_as_a_whole_study_is() -> None:
    wins, who, what = made()

    [first, second] = cells(wins, what // 6, ["anger", "joy"], who, what, null=0.5, limits=(0, 1))

    own = what < 6
    assert (first.level, second.level) == ("anger", "joy")
    whole = clustered_mean(wins[own], who[own], what[own])
    assert vars(whole).items() <= vars(first).items()
    assert not first.descriptive


def test_a_level_of_three_segments_is_described_and_not_tested() -> None:
    wins, who, what = made()

    found = cells(wins, what // 3, list("abcd"), who, what, null=0.5, limits=(0, 1))

    for cell in found:
        assert cell.descriptive
        assert math.isnan(cell.p_value)
        assert cell.low < cell.estimate < cell.high
        assert cell.segments == 3


def test_a_single_segment_has_the_interval_of_its_participants() -> None:
    wins, who, what = made()

    found = cells(wins, what, [f"s{n}" for n in range(12)], who, what, null=0.5)

    own = wins[what == 4]
    expected = stats.ttest_1samp(own, 0.5).confidence_interval()
    assert (found[4].low, found[4].high) == pytest.approx(tuple(expected))
    assert found[4].method == ONE_SEGMENT
    assert all(cell.descriptive for cell in found)


def test_levels_without_answers_are_left_out_and_others_say_why_they_have_no_interval() -> None:
    what = np.array([0, 0, 2])

    found = cells(
        np.array([1.0, 1.0, 0.0]), what, ["a", "b", "c"], np.array([0, 1, 0]), what, null=0.5
    )

    assert [cell.level for cell in found] == ["a", "c"]
    assert [cell.reason for cell in found] == ["all answers alike", "one participant"]
