from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.rankings.placements import placements, rank_summaries
from tests.analysis.stats.rankings.made_rankings import CONDITIONS, made_rankings, ranking


def test_shares_of_places_worked_by_hand():
    table = ranking({"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 1, "c": 3}, {"b": 1, "a": 2, "c": 2})
    a, b, c = rank_summaries(placements(table, ("a", "b", "c")))
    assert tuple(a.rank_percent.values()) == pytest.approx((50, 100 / 3, 100 / 6))
    assert tuple(b.rank_percent.values()) == pytest.approx((50, 50, 0))
    assert tuple(c.rank_percent.values()) == pytest.approx((0, 100 / 6, 250 / 3))
    assert [s.mean_rank.estimate for s in (a, b, c)] == pytest.approx([5 / 3, 4.5 / 3, 8.5 / 3])
    assert a.first_share.estimate == pytest.approx(0.5)


def test_places_and_conditions_both_add_up_to_a_hundred():
    found = rank_summaries(placements(made_rankings(), CONDITIONS))
    table = np.array([list(summary.rank_percent.values()) for summary in found])
    assert table.sum(axis=0) == pytest.approx([100] * 4)
    assert table.sum(axis=1) == pytest.approx([100] * 4)
    assert sum(s.first_share.estimate for s in found) == pytest.approx(1)


def test_a_mean_rank_has_the_two_way_interval_within_the_places():
    table = made_rankings()
    found = rank_summaries(placements(table, CONDITIONS))[0]
    own = table[table["condition"] == "ours"]
    expected = clustered_mean(
        own["rank"].to_numpy(float),
        own["participant"].to_numpy(str),
        own["segment"].to_numpy(str),
        null=2.5,
        limits=(1, 4),
    )
    assert found.mean_rank == expected
    assert found.first_share.p_value < 0.05
    assert found.mean_rank.participants == 22


def test_rankings_that_leave_conditions_out_are_named():
    table = ranking({"a": 1, "b": 2}, {"a": 1, "b": 2, "c": 3})
    a, _, c = rank_summaries(placements(table, ("a", "b", "c")))
    assert a.remark == "1 of 2 rankings leave conditions out"
    assert (c.remark, c.n) == ("", 1)


def test_a_condition_that_nobody_placed_says_so():
    found = rank_summaries(placements(ranking({"a": 1, "b": 2}), ("a", "b", "c")))[2]
    assert (found.n, found.mean_rank.reason) == (0, "no answers")
    assert all(math.isnan(percent) for percent in found.rank_percent.values())
