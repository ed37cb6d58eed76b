from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.placements import Placements, placements, rank_summaries
from motion.errors import InputError
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


def test_every_ranking_is_a_row_whatever_the_order_of_the_table() -> None:
    table = made_rankings(participants=4, segments=3)
    result = placements(table, ("ours", "second", "third", "last"))
    shuffled = placements(
        table.sample(frac=1, random_state=1).astype({"participant": "category"}),
        ("ours", "second", "third", "last"),
    )
    assert result.given.shape == (12, 4)

    def named(rankings: Placements) -> dict[tuple[str, str], tuple[float, ...]]:
        return {
            (rankings.participant_names[p], rankings.segment_names[s]): tuple(row)
            for p, s, row in zip(
                rankings.participants, rankings.segments, rankings.given, strict=True
            )
        }

    assert named(result) == named(shuffled)


def test_a_condition_placed_twice_is_refused() -> None:
    table = pd.concat([ranking({"a": 1, "b": 2}), ranking({"a": 2})])
    with pytest.raises(InputError, match="placed a condition twice"):
        placements(table, ABC)


def test_shares_of_places_worked_by_hand() -> None:
    table = ranking({"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 1, "c": 3}, {"b": 1, "a": 2, "c": 2})
    a, b, c = rank_summaries(placements(table, ("a", "b", "c")))
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


def test_rankings_that_leave_conditions_out_are_named() -> None:
    table = ranking({"a": 1, "b": 2}, {"a": 1, "b": 2, "c": 3})
    a, _, c = rank_summaries(placements(table, ("a", "b", "c")))
    assert a.remark == "1 of 2 rankings leave conditions out"
    assert (c.remark, c.n) == ("", 1)


def test_a_condition_that_nobody_placed_says_so() -> None:
    result = rank_summaries(placements(ranking({"a": 1, "b": 2}), ("a", "b", "c")))[2]
    assert (result.n, result.mean_rank.reason) == (0, "no answers")
    assert all(math.isnan(percent) for percent in result.rank_percent.values())
