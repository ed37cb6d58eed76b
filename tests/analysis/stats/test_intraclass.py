from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from analysis.stats.intraclass import COMPLETE, INCOMPLETE, Intraclass, intraclass_correlation

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
    values = np.asarray(table, np.float64)
    there = ~np.isnan(values)
    items, raters = np.nonzero(there)
    return intraclass_correlation(values[there], raters, items)


def drawn(
    generator: np.random.Generator,
    items: int = 20,
    raters: int = 15,
    item_sd: float = 0.6,
    rater_sd: float = 0.6,
    missing: float = 0.0,
) -> NDArray[np.float64]:
    table = (
        generator.normal(0, item_sd, (items, 1))
        + generator.normal(0, rater_sd, (1, raters))
        + generator.normal(0, 1, (items, raters))
    )
    return np.where(generator.random(table.shape) < missing, np.nan, table)


def test_it_is_what_shrout_and_fleiss_published() -> None:
    result = of(SHROUT_AND_FLEISS)
    assert round(result.single.estimate, 2) == 0.29
    assert round(result.average.estimate, 2) == 0.62
    assert (result.single.low, result.single.high) == pytest.approx((0.019, 0.761), abs=5e-4)
    assert (result.average.low, result.average.high) == pytest.approx((0.071, 0.927), abs=5e-4)
    assert result.method == COMPLETE


def test_missing_answers_are_named_and_bias_nothing() -> None:
    generator = np.random.default_rng(1)
    result = [of(drawn(generator, missing=0.4)) for _ in range(200)]
    assert all(f.method == INCOMPLETE for f in result)
    assert np.mean([f.item_variance for f in result]) == pytest.approx(0.36, abs=0.03)
    assert np.mean([f.rater_variance for f in result]) == pytest.approx(0.36, abs=0.04)
    assert np.mean([f.residual_variance for f in result]) == pytest.approx(1, abs=0.03)


def test_intervals_of_incomplete_tables_hold() -> None:
    generator = np.random.default_rng(2)
    truth = 0.36 / 1.72
    result = [of(drawn(generator, missing=0.5)).single for _ in range(200)]
    assert np.mean([f.low <= truth <= f.high for f in result]) > 0.92


def test_items_alike_give_a_number_below_zero_and_no_error() -> None:
    result = of([[1, 2, 3], [2, 3, 1], [3, 1, 2]])
    assert result.single.estimate < 0
    assert result.average.low == -1


def test_judges_who_differ_by_a_constant_only_give_no_error() -> None:
    result = of([[1, 2, 3], [1, 2, 3], [1, 2, 3]])
    assert result.residual_variance == 0
    assert result.single.low <= result.single.estimate <= result.single.high
