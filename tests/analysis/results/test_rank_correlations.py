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


def _signs(values: list[float]) -> np.ndarray:
    return order_signs(np.array([values], float))


@pytest.mark.parametrize("second", [[5, 3, 4, 1, 2], [1, 1, 2, 2, 2], [3, 1, 1, 4, 5]])
def test_both_agree_with_scipy_ties_included(second: list[float]) -> None:
    first = [1.0, 2.0, 2.0, 4.0, 5.0]
    once = np.ones((1, 5))
    assert kendall(_signs(first), _signs(second), once)[0] == pytest.approx(
        stats.kendalltau(first, second).statistic
    )
    assert spearman(_signs(first), _signs(second), once)[0] == pytest.approx(
        stats.spearmanr(first, second).statistic
    )


def test_what_is_drawn_twice_counts_twice() -> None:
    first, second = np.array([1.0, 2, 3, 4]), np.array([2.0, 1, 4, 3])
    times = np.array([2, 0, 1, 3])
    again = np.repeat(first, times), np.repeat(second, times)
    weights = times[None].astype(float)
    signs = _signs(list(first)), _signs(list(second))
    assert kendall(*signs, weights)[0] == pytest.approx(stats.kendalltau(*again).statistic)
    assert spearman(*signs, weights)[0] == pytest.approx(stats.spearmanr(*again).statistic)


def test_one_condition_drawn_alone_has_no_correlation() -> None:
    signs = _signs([1, 2, 3])
    alone = np.array([[3.0, 0, 0]])
    assert np.isnan(kendall(signs, signs, alone)[0])
    assert np.isnan(spearman(signs, signs, alone)[0])


def test_values_equal_but_for_rounding_are_ties() -> None:
    assert not order_signs(np.array([[0.1 + 0.2, 0.3]])).any()


def test_ten_conditions_show_a_true_half_as_anything_from_nearly_none_to_nearly_all() -> None:
    result = sampling_range(10)
    assert (round(result.low, 2), round(result.high, 2)) == (0.07, 0.82)


def test_more_conditions_show_more() -> None:
    widths = [sampling_range(k).high - sampling_range(k).low for k in (5, 10, 20)]
    assert widths == sorted(widths, reverse=True)


def test_ten_conditions_in_perfect_order_rule_out_no_relation_and_four_do_not() -> None:
    low, high = compatible(1.0, 4, "kendall")
    assert low < 0
    assert high == 1
    assert compatible(1.0, 10, "kendall")[0] > 0.7


@pytest.mark.parametrize("kind", ["kendall", "spearman"])
def test_what_fits_lies_around_the_estimate_and_is_mirrored_with_it(kind: Kind) -> None:
    low, high = compatible(0.4, 6, kind)
    assert low < 0.4 < high
    assert compatible(-0.4, 6, kind) == (-high, -low)
