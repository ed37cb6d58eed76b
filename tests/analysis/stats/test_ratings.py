from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np
import pandas as pd
import pytest
from statsmodels.regression.linear_model import OLS
from statsmodels.stats.sandwich_covariance import cov_cluster_2groups

from analysis.stats.clustered_mean import Estimate, clustered_mean
from analysis.stats.ratings import (
    cliffs_delta,
    mean_difference,
    rated_cells,
    rating_table,
)

SCORES = (1, 2, 3, 4, 5)

CONDITIONS = ("ours", "other", "static")


def made(seed: int = 1) -> tuple[np.ndarray, ...]:
    """Return ratings, conditions, participants and segments of a crossed study."""
    chance = np.random.default_rng(seed)
    people, items, which = (part.ravel() for part in np.indices((10, 8, 3)))
    taste = chance.normal(size=(10, 3))[people, which] + chance.normal(size=(8, 3))[items, which]
    level = chance.normal(size=10)[people]
    values = np.clip(np.rint(3 + 0.5 * (which == 0) + taste + level), 1, 5)
    return values, which, people, items


def test_paired_ratings_are_differences_of_one_participant_and_segment() -> None:
    values, which, people, items = made()
    table = values.reshape(80, 3)

    cells = rated_cells(values, which, people, items, count=3)

    for a, b in combinations(range(3), 2):
        one = mean_difference(cells, a, b)
        by_hand = clustered_mean(
            table[:, a] - table[:, b], people[::3], items[::3], null=0, limits=(-9, 9)
        )
        assert (one.estimate, one.low, one.high, one.p_value) == pytest.approx(
            (by_hand.estimate, by_hand.low, by_hand.high, by_hand.p_value)
        )
        assert one.n == 80
        assert one.method.startswith("paired ratings, clustered by")


def test_ratings_without_a_partner_are_left_out_while_they_are_few() -> None:
    values, which, people, items = made()
    few = ~((which == 0) & (items < 2))

    result = mean_difference(
        rated_cells(values[few], which[few], people[few], items[few], count=3), 0, 1
    )

    assert result.n == 60
    assert result.segments == 6


def test_without_pairs_it_is_the_difference_of_two_means() -> None:
    values, which, people, items = made(seed=3)
    apart = which == (people + items) % 3
    y, first = values[apart], which[apart] == 0
    two = which[apart] < 2

    result = mean_difference(
        rated_cells(y, which[apart], people[apart], items[apart], count=3), 0, 1
    )

    design = np.column_stack([np.ones(two.sum()), first[two]])
    fitted = OLS(y[two], design).fit()
    expected = cov_cluster_2groups(fitted, people[apart][two], items[apart][two])[0][1, 1]
    expected *= (two.sum() - 2) / (two.sum() - 1)  # Its factor for few answers.
    assert result.method.startswith("all ratings")
    assert result.estimate == pytest.approx(fitted.params[1])
    assert result.standard_error == pytest.approx(math.sqrt(expected), rel=1e-3)


def test_ratings_given_twice_count_as_their_mean() -> None:
    values, which, people, items = made()
    once = mean_difference(rated_cells(values, which, people, items, count=3), 0, 2)
    doubled = (np.tile(part, 2) for part in (values, which, people, items))
    twice = mean_difference(rated_cells(*doubled, count=3), 0, 2)
    assert twice == once


def of(ratings: pd.DataFrame, first: str, second: str) -> Estimate:
    both = ratings[ratings["condition"].isin([first, second])]
    return cliffs_delta(
        both["value"].to_numpy(),
        (both["condition"] == first).to_numpy(),
        both["participant"].to_numpy(str),
        both["segment"].to_numpy(str),
    )


def test_cliffs_delta_is_the_mean_of_all_pairs() -> None:
    ratings = made_ratings(participants=5, segments=4)
    ours, other = (
        ratings.loc[ratings["condition"] == name, "value"].to_numpy() for name in ("ours", "other")
    )
    expected = np.sign(ours[:, None] - other).mean()
    assert of(ratings, "ours", "other").estimate == pytest.approx(expected)


def test_the_interval_holds_where_participants_and_segments_differ() -> None:
    estimates = [of(made_ratings(effects=(0, 0, 0), seed=k), "ours", "other") for k in range(60)]
    assert np.mean([d.low <= 0 <= d.high for d in estimates]) > 0.92


def test_a_score_that_nobody_gave_is_counted_as_zero() -> None:
    [result] = rating_table(made_ratings().query("value in [2, 4]"), ["ours"], SCORES)
    assert list(result.counts) == [1, 2, 3, 4, 5]
    assert result.counts[3] == 0
    assert result.at_least[1] == 100
    assert result.at_least[3] == result.at_least[4]


def made_ratings(
    *,
    participants: int = 20,
    segments: int = 8,
    effects: Sequence[float] = (0.0, -0.5, -1.2),
    seed: int = 1,
) -> pd.DataFrame:
    """Return ratings 1 to 5 of every condition by every participant in every segment."""
    generator = np.random.default_rng(seed)
    people, items, which = (
        index.ravel() for index in np.indices((participants, segments, len(effects)))
    )
    latent = (
        np.asarray(effects)[which]
        + generator.normal(0, 1, participants)[people]
        + generator.normal(0, 0.4, segments)[items]
        + generator.logistic(size=len(people))
    )
    return pd.DataFrame(
        {
            "participant": [f"p{k:02d}" for k in people],
            "segment": [f"s{k}" for k in items],
            "condition": np.array(CONDITIONS)[which],
            "value": np.digitize(latent, [-2.5, -1.0, 0.4, 2.0]) + 1,
        }
    )
