from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike

from analysis.stats.intraclass import COMPLETE, INCOMPLETE, Intraclass, intraclass_correlation
from tests.analysis.stats.tables import cells

SHROUT_AND_FLEISS = [
    [9, 2, 5, 8],
    [6, 1, 3, 2],
    [8, 4, 6, 8],
    [7, 1, 2, 6],
    [10, 5, 6, 9],
    [6, 2, 4, 7],
]
"""Six items, four judges: the example of Shrout & Fleiss (1979)."""


def of(table: ArrayLike) -> Intraclass:
    """Return the result for a table of items (rows) by raters; NaN is missing."""
    values, items, raters = cells(table)
    return intraclass_correlation(values, raters, items)


def test_it_matches_shrout_and_fleiss() -> None:
    result = of(SHROUT_AND_FLEISS)
    assert round(result.single.estimate, 2) == 0.29
    assert round(result.average.estimate, 2) == 0.62
    assert (result.single.low, result.single.high) == pytest.approx((0.019, 0.761), abs=5e-4)
    assert (result.average.low, result.average.high) == pytest.approx((0.071, 0.927), abs=5e-4)
    assert result.method == COMPLETE


def test_missing_answers_are_noted_and_leave_estimates_and_intervals_valid() -> None:
    chance = np.random.default_rng(1)
    results = []
    for _ in range(200):
        table = (
            chance.normal(0, 0.6, (20, 1))
            + chance.normal(0, 0.6, 15)
            + chance.normal(0, 1, (20, 15))
        )
        results.append(of(np.where(chance.random(table.shape) < 0.4, np.nan, table)))
    assert {result.method for result in results} == {INCOMPLETE}
    for name, variance in (("item", 0.36), ("rater", 0.36), ("residual", 1)):
        estimates = [getattr(result, f"{name}_variance") for result in results]
        assert np.mean(estimates) == pytest.approx(variance, abs=0.04)
    truth = 0.36 / 1.72
    intervals = [result.single for result in results]
    assert np.mean([single.low <= truth <= single.high for single in intervals]) > 0.92


def test_identical_items_score_below_zero_and_identical_judges_leave_no_residual() -> None:
    alike = of([[1, 2, 3], [2, 3, 1], [3, 1, 2]])
    assert alike.single.estimate < 0
    assert alike.average.low == -1
    constant = of([[1, 2, 3], [1, 2, 3], [1, 2, 3]])
    assert constant.residual_variance == 0
    assert constant.single.low <= constant.single.estimate <= constant.single.high
