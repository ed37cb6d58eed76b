from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from analysis.rankings.kendall_w import kendall_w
from analysis.rankings.placements import placements
from tests.analysis.rankings.made_rankings import CONDITIONS, made_rankings, ranking

ABC = ("a", "b", "c")


def test_it_is_one_where_all_agree_and_zero_where_they_cancel():
    alike = kendall_w(placements(ranking(*[{"a": 1, "b": 2, "c": 3}] * 4), ABC))
    turns = ({"a": 1, "b": 2, "c": 3}, {"a": 2, "b": 3, "c": 1}, {"a": 3, "b": 1, "c": 2})
    assert alike.segments[0].estimate == pytest.approx(1)
    assert kendall_w(placements(ranking(*turns), ABC)).segments[0].estimate == 0


def test_with_ties_it_is_the_corrected_formula():
    rows = [{"a": 1, "b": 2, "c": 2, "d": 4}, {"a": 1, "b": 1, "c": 3, "d": 3}]
    [found] = kendall_w(placements(ranking(*rows), ("a", "b", "c", "d"))).segments
    # Written out from Siegel & Castellan (1988); the sums of ranks are 2.5, 4, 6 and 7.5.
    spread = np.sum((np.array([2.5, 4, 6, 7.5]) - 5) ** 2)
    ties = (2**3 - 2) + 2 * (2**3 - 2)
    assert found.estimate == pytest.approx(12 * spread / (4 * (4**3 - 4) - 2 * ties))
    correlation = np.corrcoef([1, 2.5, 2.5, 4], [1.5, 1.5, 3.5, 3.5])[0, 1]
    assert found.mean_correlation == pytest.approx(correlation, abs=0.02)


def test_every_segment_and_the_whole_are_told_apart():
    table = made_rankings()
    found = kendall_w(placements(table, CONDITIONS))
    assert [s.segment for s in found.segments] == [f"s{k}" for k in range(8)]
    assert found.mean == pytest.approx(np.mean([s.estimate for s in found.segments]))
    ranks = table.pivot_table(index="participant", columns="condition", values="rank")
    whole = stats.friedmanchisquare(*(-ranks.to_numpy().round(9)).T)
    assert found.overall.statistic == pytest.approx(whole.statistic)
    assert found.overall.n == 22
    assert all(s.n == 22 and s.p_value < 1 for s in found.segments)


def test_rankings_that_leave_conditions_out_are_left_out_and_counted():
    rows = [{"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 2}]
    [found] = kendall_w(placements(ranking(*rows), ABC)).segments
    assert (found.n, found.incomplete) == (2, 1)


def test_one_participant_agrees_with_nobody():
    found = kendall_w(placements(ranking({"a": 1, "b": 2, "c": 3}), ABC))
    assert found.segments[0].reason == "fewer than two participants with all conditions"
    assert math.isnan(found.mean)
