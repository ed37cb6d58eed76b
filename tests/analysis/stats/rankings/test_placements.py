from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from analysis.stats.rankings.placements import placements
from motion.errors import InputError
from tests.analysis.stats.rankings.made_rankings import made_rankings, ranking

ABC = ("a", "b", "c")


def test_ties_share_the_mean_of_their_places_however_they_are_numbered():
    for tied in (1, 2):
        found = placements(ranking({"a": 1, "b": 1, "c": tied + 1}), ABC)
        assert found.ranks.tolist() == [[1.5, 1.5, 3]]
        assert found.better.tolist() == [[0, 0, 2]]
        assert found.tied.tolist() == [[2, 2, 1]]


def test_a_condition_left_out_has_no_rank_and_takes_none():
    found = placements(ranking({"a": 2, "c": 1}), ABC)
    assert found.ranks[0, [0, 2]].tolist() == [2, 1]
    assert np.isnan(found.ranks[0, 1])
    assert found.complete.tolist() == [False]


def test_every_ranking_is_a_row_whatever_the_order_of_the_table():
    table = made_rankings(participants=4, segments=3)
    found = placements(table, ("ours", "second", "third", "last"))
    shuffled = placements(
        table.sample(frac=1, random_state=1).astype({"participant": "category"}),
        ("ours", "second", "third", "last"),
    )
    assert found.given.shape == (12, 4)

    def named(rankings):
        return {
            (rankings.participant_names[p], rankings.segment_names[s]): tuple(row)
            for p, s, row in zip(
                rankings.participants, rankings.segments, rankings.given, strict=True
            )
        }

    assert named(found) == named(shuffled)


def test_conditions_that_are_not_asked_for_do_not_count():
    found = placements(ranking({"a": 1, "reference": 1, "b": 2, "c": 3}), ABC)
    assert found.ranks.tolist() == [[1, 2, 3]]


def test_a_condition_placed_twice_is_refused():
    table = pd.concat([ranking({"a": 1, "b": 2}), ranking({"a": 2})])
    with pytest.raises(InputError, match="placed a condition twice"):
        placements(table, ABC)
