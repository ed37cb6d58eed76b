from __future__ import annotations

import numpy as np

from analysis.strengths.rank_intervals import errors_of_differences, rank_intervals

APART = errors_of_differences(0.01 * np.eye(3))


def test_clear_differences_give_one_rank_each() -> None:
    found = rank_intervals(np.array([0.0, 2.0, -2.0]), APART)

    assert found == ((2, 2), (1, 1), (3, 3))


def test_what_cannot_be_told_apart_shares_its_ranks() -> None:
    found = rank_intervals(np.array([0.0, 0.1, -2.0]), APART)

    assert found == ((1, 2), (1, 2), (3, 3))


def test_unknown_strengths_may_have_every_rank() -> None:
    assert rank_intervals(np.full(3, np.nan), APART) == ((1, 3),) * 3


def test_the_true_rank_is_inside_nearly_always() -> None:
    chance = np.random.default_rng(1)
    truth = np.array([0.3, 0.1, 0.0, -0.4])
    covariance = 0.02 * np.eye(4)
    inside = []
    for _ in range(300):
        drawn = chance.multivariate_normal(truth, covariance)
        intervals = rank_intervals(drawn, errors_of_differences(covariance))
        inside.append(all(low <= n <= high for n, (low, high) in enumerate(intervals, start=1)))

    assert np.mean(inside) > 0.93
