from __future__ import annotations

import krippendorff
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats
from statsmodels.stats.inter_rater import cohens_kappa

from analysis.stats.agreement import krippendorff_alpha, retest_agreement
from tests.analysis.stats.tables import cells


def drawn(items: int = 15, missing: float = 0.3) -> NDArray[np.float64]:
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


def made() -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
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
