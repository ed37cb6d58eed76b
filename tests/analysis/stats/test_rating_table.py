from __future__ import annotations

import math

import pandas as pd
import pytest

from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.ratings import rating_table
from motion.errors import InputError
from tests.analysis.reference import reference_ratings, with_reference
from tests.analysis.stats.made_ratings import CONDITIONS, made_ratings

SCORES = (1, 2, 3, 4, 5)


@with_reference
def test_it_agrees_with_the_reference():
    ratings, reference = reference_ratings()
    expected = reference["table2"]
    tidy = ratings.rename(columns={"item": "segment", "method": "condition", "rating": "value"})

    for found in rating_table(tidy, list(expected), SCORES):
        row = expected[found.condition]
        assert found.n == row["n"]
        assert found.estimate == pytest.approx(row["mean"], abs=1e-9)
        assert found.sd == pytest.approx(row["sd"], abs=1e-9)
        assert {str(score): n for score, n in found.counts.items()} == row["counts"]
        at_least = {str(score): percent for score, percent in found.at_least.items()}
        assert at_least == pytest.approx(row["cumulative_lower_bound_pct"], abs=1e-9)


def test_a_mean_has_the_two_way_interval_within_the_scale():
    ratings = made_ratings()
    found = rating_table(ratings, CONDITIONS, SCORES)[0]
    own = ratings[ratings["condition"] == "ours"]
    expected = clustered_mean(
        own["value"].to_numpy(float),
        own["participant"].to_numpy(str),
        own["segment"].to_numpy(str),
        limits=(1, 5),
    )
    assert (found.low, found.high) == pytest.approx((expected.low, expected.high))
    assert 1 < found.low < found.high < 5
    assert math.isnan(found.p_value)


def test_a_score_that_nobody_gave_is_counted_as_zero():
    [found] = rating_table(made_ratings().query("value in [2, 4]"), ["ours"], SCORES)
    assert list(found.counts) == [1, 2, 3, 4, 5]
    assert found.counts[3] == 0
    assert found.at_least[1] == 100
    assert found.at_least[3] == found.at_least[4]


def test_a_condition_without_ratings_says_so():
    [found] = rating_table(made_ratings(), ["absent"], SCORES)
    assert (found.n, found.reason) == (0, "no answers")
    assert math.isnan(found.sd)
    assert math.isnan(found.at_least[1])


def test_a_score_off_the_scale_is_refused():
    ratings = pd.DataFrame(
        {"participant": ["a"], "segment": ["x"], "condition": ["ours"], "value": [6]}
    )
    with pytest.raises(InputError, match="6, which is not one of the scores 1, 2, 3, 4, 5"):
        rating_table(ratings, ["ours"], SCORES)
