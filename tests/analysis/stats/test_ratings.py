import math
from itertools import combinations

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from statsmodels.regression.linear_model import OLS
from statsmodels.stats.sandwich_covariance import cov_cluster_2groups

from analysis.stats.clustered_mean import Estimate, clustered_mean
from analysis.stats.ratings import cliffs_delta, mean_difference, rated_cells, rating_table


def made(seed: int = 1) -> tuple[np.ndarray, ...]:
    """Return ratings, conditions, participants and segments of a crossed study."""
    chance = np.random.default_rng(seed)
    people, items, which = (part.ravel() for part in np.indices((10, 8, 3)))
    taste = chance.normal(size=(10, 3))[people, which] + chance.normal(size=(8, 3))[items, which]
    level = chance.normal(size=10)[people]
    values = np.clip(np.rint(3 + 0.5 * (which == 0) + taste + level), 1, 5)
    return values, which, people, items


def test_ratings_are_paired_by_participant_and_segment() -> None:
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


def test_a_few_unpaired_ratings_are_left_out() -> None:
    _, which, _, items = made()
    few = ~((which == 0) & (items < 2))

    result = mean_difference(rated_cells(*(part[few] for part in made()), count=3), 0, 1)

    assert result.n == 60
    assert result.segments == 6


def test_unpaired_ratings_give_the_difference_of_two_means() -> None:
    _, which, people, items = made(seed=3)
    apart = which == (people + items) % 3
    values, which, people, items = (part[apart] for part in made(seed=3))
    two = which < 2

    result = mean_difference(rated_cells(values, which, people, items, count=3), 0, 1)

    design = np.column_stack([np.ones(two.sum()), which[two] == 0])
    fitted = OLS(values[two], design).fit()
    expected = cov_cluster_2groups(fitted, people[two], items[two])[0][1, 1]
    expected *= (two.sum() - 2) / (two.sum() - 1)  # Its factor for few answers.
    assert result.method.startswith("all ratings")
    assert result.estimate == pytest.approx(fitted.params[1])
    assert result.standard_error == pytest.approx(math.sqrt(expected), rel=1e-3)


def test_repeated_ratings_count_as_their_mean() -> None:
    values, which, people, items = made()
    once = mean_difference(rated_cells(values, which, people, items, count=3), 0, 2)
    doubled = (np.tile(part, 2) for part in (values, which, people, items))
    twice = mean_difference(rated_cells(*doubled, count=3), 0, 2)
    assert twice == once


def delta(seed: int) -> tuple[Estimate, np.ndarray, np.ndarray]:
    """Return Cliff's delta of two equally rated conditions, and their ratings."""
    values, which, people, items = made(seed)
    two = which > 0
    result = cliffs_delta(values[two], which[two] == 1, people[two], items[two])
    return result, values[which == 1], values[which == 2]


def test_cliffs_delta_is_the_mean_over_all_pairs_with_a_valid_interval() -> None:
    result, first, second = delta(1)
    assert result.estimate == pytest.approx(np.sign(first[:, None] - second).mean())
    # The interval is even on the scale of Fisher's z, where the error is larger than that of delta.
    low, centre, high = np.arctanh([result.low, result.estimate, result.high])
    margin = stats.t(result.df).ppf(0.975) * result.standard_error / (1 - result.estimate**2)
    assert (centre - low, high - centre) == pytest.approx((margin, margin))
    estimates = [delta(seed)[0] for seed in range(60)]
    assert np.mean([each.low <= 0 <= each.high for each in estimates]) > 0.92


def test_unused_scores_are_counted_as_zero() -> None:
    ratings = pd.DataFrame({"participant": [*"aabb"], "segment": [*"xyxy"], "condition": "ours"})
    [result] = rating_table(ratings.assign(value=[2, 4, 4, 2]), ["ours"], (1, 2, 3, 4, 5))
    assert result.counts == {1: 0, 2: 2, 3: 0, 4: 2, 5: 0}
    assert result.at_least == {1: 100, 2: 100, 3: 50, 4: 50, 5: 0}
