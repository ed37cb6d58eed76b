from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.stats.rating_differences import cliffs_delta
from tests.analysis.reference import reference_ratings, with_reference
from tests.analysis.stats.made_ratings import made_ratings


def of(ratings, first, second):
    both = ratings[ratings["condition"].isin([first, second])]
    return cliffs_delta(
        both["value"].to_numpy(),
        (both["condition"] == first).to_numpy(),
        both["participant"].to_numpy(str),
        both["segment"].to_numpy(str),
    )


@with_reference
def test_it_agrees_with_the_reference():
    ratings, reference = reference_ratings()
    tidy = ratings.rename(columns={"item": "segment", "method": "condition", "rating": "value"})
    for pair, expected in reference["cliffs_delta_pooled"].items():
        assert of(tidy, *pair.split("_vs_")).estimate == pytest.approx(expected, abs=1e-12)


def test_it_is_the_mean_of_all_pairs():
    ratings = made_ratings(participants=5, segments=4)
    ours, other = (
        ratings.loc[ratings["condition"] == name, "value"].to_numpy() for name in ("ours", "other")
    )
    expected = np.sign(ours[:, None] - other).mean()
    assert of(ratings, "ours", "other").estimate == pytest.approx(expected)


def test_turning_the_pair_round_mirrors_the_interval():
    found = of(made_ratings(), "ours", "static")
    turned = of(made_ratings(), "static", "ours")
    assert turned.estimate == pytest.approx(-found.estimate)
    assert (turned.low, turned.high) == pytest.approx((-found.high, -found.low))
    assert found.low < found.estimate < found.high


def test_the_interval_holds_where_participants_and_segments_differ():
    estimates = [of(made_ratings(effects=(0, 0, 0), seed=k), "ours", "other") for k in range(60)]
    assert np.mean([d.low <= 0 <= d.high for d in estimates]) > 0.92


@pytest.mark.parametrize(
    ("values", "first", "people", "reason"),
    [
        ([1, 2], [True, True], [0, 1], "one of the conditions has no ratings"),
        ([1, 2, 2, 1], [True, False, True, False], [0, 0, 0, 0], "one participant"),
        ([4, 5, 1, 2], [True, True, False, False], [0, 1, 0, 1], "the ratings do not overlap"),
        ([3, 3, 3, 3], [True, True, False, False], [0, 1, 0, 1], "all ratings alike"),
    ],
)
def test_no_interval_comes_with_its_reason(values, first, people, reason):
    segments = np.arange(len(values))
    found = cliffs_delta(np.array(values), np.array(first), np.array(people), segments)
    assert found.reason == reason
    assert math.isnan(found.low)


def test_ratings_that_do_not_overlap_still_have_an_estimate():
    found = cliffs_delta(
        np.array([4, 5, 1, 2]), np.array([True, True, False, False]), np.arange(4), np.arange(4)
    )
    assert found.estimate == 1
