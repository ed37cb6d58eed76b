from __future__ import annotations

import numpy as np
import pytest

from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.rankings import placements, rank_summaries
from tests.analysis.stats.made_rankings import CONDITIONS, made_rankings, ranking

ABC = ("a", "b", "c")


def test_ties_share_the_mean_of_their_places_however_they_are_numbered() -> None:
    for tied in (1, 2):
        result = placements(ranking({"a": 1, "b": 1, "c": tied + 1}), ABC)
        assert result.ranks.tolist() == [[1.5, 1.5, 3]]
        assert result.better.tolist() == [[0, 0, 2]]
        assert result.tied.tolist() == [[2, 2, 1]]


def test_a_condition_left_out_has_no_rank_and_takes_none() -> None:
    result = placements(ranking({"a": 2, "c": 1}), ABC)
    assert result.ranks[0, [0, 2]].tolist() == [2, 1]
    assert np.isnan(result.ranks[0, 1])
    assert result.complete.tolist() == [False]


def test_shares_of_places_worked_by_hand() -> None:
    table = ranking({"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 1, "c": 3}, {"b": 1, "a": 2, "c": 2})
    a, b, c = rank_summaries(placements(table, ABC))
    assert tuple(a.rank_percent.values()) == pytest.approx((50, 100 / 3, 100 / 6))
    assert tuple(b.rank_percent.values()) == pytest.approx((50, 50, 0))
    assert tuple(c.rank_percent.values()) == pytest.approx((0, 100 / 6, 250 / 3))
    assert [s.mean_rank.estimate for s in (a, b, c)] == pytest.approx([5 / 3, 4.5 / 3, 8.5 / 3])
    assert a.first_share.estimate == pytest.approx(0.5)


def test_a_mean_rank_has_the_two_way_interval_within_the_places() -> None:
    table = made_rankings()
    result = rank_summaries(placements(table, CONDITIONS))[0]
    own = table[table["condition"] == "ours"]
    expected = clustered_mean(
        own["rank"].to_numpy(float),
        own["participant"].to_numpy(str),
        own["segment"].to_numpy(str),
        null=2.5,
        limits=(1, 4),
    )
    assert result.mean_rank == expected
    assert result.first_share.p_value < 0.05
    assert result.mean_rank.participants == 22
