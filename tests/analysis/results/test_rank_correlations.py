"""Rank correlations over conditions, and which of them few conditions allow."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from analysis.results.rank_correlations import (
    Kind,
    compatible,
    kendall,
    order_signs,
    sampling_range,
    spearman,
)

ONCE = np.ones(5, int)


@pytest.mark.parametrize(
    ("second", "times"),
    [
        ([5, 3, 4, 1, 2], ONCE),
        ([1, 1, 2, 2, 2], ONCE),
        # Drawn twice is counted twice, and tied with itself.
        ([3, 1, 1, 4, 5], np.array([2, 0, 1, 3, 1])),
        # Equal but for rounding.
        ([0.1 + 0.2, 0.3, 0.4, 0.1, 0.2], ONCE),
    ],
)
def test_both_correlations_agree_with_scipy_with_ties_and_weights(
    second: list[float], times: np.ndarray
) -> None:
    first = np.array([1.0, 2.0, 2.0, 4.0, 5.0])
    signs = order_signs(first[None]), order_signs(np.array([second]))
    drawn = np.repeat(first, times), np.repeat(np.round(second, 9), times)
    weights = times[None].astype(float)
    assert kendall(*signs, weights)[0] == pytest.approx(stats.kendalltau(*drawn).statistic)
    assert spearman(*signs, weights)[0] == pytest.approx(stats.spearmanr(*drawn).statistic)


def test_with_ten_conditions_a_true_half_varies_from_nearly_none_to_nearly_one() -> None:
    result = sampling_range(10)
    assert (round(result.low, 2), round(result.high, 2)) == (0.07, 0.82)


def test_a_perfect_order_excludes_zero_with_ten_conditions_but_not_with_four() -> None:
    low, high = compatible(1.0, 4, "kendall")
    assert low < 0
    assert high == 1
    assert compatible(1.0, 10, "kendall")[0] > 0.7


@pytest.mark.parametrize("kind", ["kendall", "spearman"])
def test_compatible_correlations_surround_the_estimate_and_mirror_with_it(kind: Kind) -> None:
    low, high = compatible(0.4, 6, kind)
    assert low < 0.4 < high
    assert compatible(-0.4, 6, kind) == (-high, -low)
