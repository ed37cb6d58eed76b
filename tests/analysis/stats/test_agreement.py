import krippendorff
import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy import stats
from statsmodels.stats.inter_rater import cohens_kappa

from analysis.stats.agreement import krippendorff_alpha, retest_agreement
from analysis.stats.intraclass import COMPLETE, INCOMPLETE, Intraclass, intraclass_correlation
from motion.arrays import Floats, Indices
from tests.analysis.stats.tables import cells


def drawn(items: int = 15, missing: float = 0.3) -> Floats:
    generator = np.random.default_rng(1)
    table = np.rint(
        np.clip(generator.normal(3, 1, items) + generator.normal(0, 1, (8, items)), 1, 5)
    )
    return np.where(generator.random(table.shape) < missing, np.nan, table)


def test_alpha_agrees_with_another_implementation() -> None:
    table = drawn()
    result = krippendorff_alpha(*cells(table))
    assert result.estimate == pytest.approx(
        krippendorff.alpha(table, level_of_measurement="ordinal")
    )
    answered = (~np.isnan(table)).sum(axis=0)
    assert (result.n, result.items) == (answered[answered > 1].sum(), (answered > 1).sum())


def test_a_resample_is_alpha_of_the_items_drawn() -> None:
    table = drawn(items=2, missing=0)
    both = krippendorff_alpha(*cells(table))
    alone = [
        krippendorff.alpha(np.repeat(table[:, [item]], 2, axis=1), level_of_measurement="ordinal")
        for item in (0, 1)
    ]
    assert both.low == pytest.approx(min(*alone, both.estimate))
    assert both.high == pytest.approx(max(*alone, both.estimate))


def made() -> tuple[Indices, Indices, Indices]:
    """Return the answers of 30 participants to three trials and to their repeats."""
    generator = np.random.default_rng(1)
    latent = generator.normal(0, 1, 90)
    first, again = (
        np.clip(np.rint(latent + generator.normal(0, 0.8, 90)), -2, 2).astype(int) for _ in range(2)
    )
    return first, again, np.repeat(np.arange(30), 3)


def test_kappa_agrees_with_another_implementation() -> None:
    first, again, people = made()
    table = np.zeros((5, 5))
    np.add.at(table, (first + 2, again + 2), 1)
    result = retest_agreement(first, again, people)
    assert result.estimate == pytest.approx(cohens_kappa(table, wt="quadratic").kappa)
    assert result.spearman == pytest.approx(stats.spearmanr(first, again).statistic)
    assert result.equal_share == pytest.approx((first == again).mean())
    assert result.low < result.estimate < result.high
    assert (result.n, result.participants, result.reason) == (90, 30, "")


def test_a_participant_counts_as_one_however_many_trials() -> None:
    first, again, people = made()
    thrice = [np.tile(column, 3) for column in (first, again, people)]
    once, more = retest_agreement(first, again, people), retest_agreement(*thrice)
    assert (more.low, more.high) == pytest.approx((once.low, once.high))
    assert more.n == 3 * once.n


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
