from __future__ import annotations

import math
from collections.abc import Callable

import krippendorff
import numpy as np
import pandas as pd
import pytest
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from statsmodels.stats.inter_rater import cohens_kappa

from analysis.stats.agreement import krippendorff_alpha, retest_agreement
from analysis.stats.intraclass import intraclass_correlation
from motion.errors import InputError
from tests.analysis.reference import REFERENCE, with_reference

PUBLISHED = 0.815
"""Of ordinal values, in Krippendorff (2011)."""


def answers(table: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.intp], NDArray[np.intp]]:
    """Return values, raters and items of a table of raters (rows) by items; NaN is missing."""
    values = np.asarray(table, np.float64)
    there = ~np.isnan(values)
    raters, items = np.nonzero(there)
    return values[there], raters, items


def drawn(
    seed: int = 1, raters: int = 8, items: int = 15, missing: float = 0.3
) -> NDArray[np.float64]:
    generator = np.random.default_rng(seed)
    table = np.rint(
        np.clip(generator.normal(3, 1, items) + generator.normal(0, 1, (raters, items)), 1, 5)
    )
    return np.where(generator.random(table.shape) < missing, np.nan, table)


@with_reference
def test_it_is_what_krippendorff_published() -> None:
    table = pd.read_csv(REFERENCE / "krippendorff2011.csv").melt("observer").dropna()
    result = krippendorff_alpha(
        table["value"].to_numpy(),
        table["observer"].to_numpy(str),
        table["variable"].to_numpy(str),
    )
    assert round(result.estimate, 3) == PUBLISHED
    assert (result.n, result.items, result.participants) == (40, 11, 4)
    assert result.low < result.estimate < result.high


@pytest.mark.parametrize("seed", [1, 2])
def test_it_agrees_with_another_implementation(seed: int) -> None:
    table = drawn(seed)
    expected = krippendorff.alpha(table, level_of_measurement="ordinal")
    result = krippendorff_alpha(*answers(table), resamples=50)
    assert result.estimate == pytest.approx(expected)


def test_a_resample_is_alpha_of_the_items_drawn() -> None:
    table = drawn(items=2, missing=0)
    both = krippendorff_alpha(*answers(table), resamples=400)
    alone = [
        krippendorff.alpha(np.repeat(table[:, [item]], 2, axis=1), level_of_measurement="ordinal")
        for item in (0, 1)
    ]
    assert both.low == pytest.approx(min(*alone, both.estimate))
    assert both.high == pytest.approx(max(*alone, both.estimate))


def test_the_same_seed_gives_the_same_interval() -> None:
    data = answers(drawn())
    assert krippendorff_alpha(*data, seed=3) == krippendorff_alpha(*data, seed=3)
    assert krippendorff_alpha(*data, seed=3) != krippendorff_alpha(*data, seed=4)


@pytest.mark.parametrize("statistic", [krippendorff_alpha, intraclass_correlation])
def test_two_answers_of_one_participant_about_an_item_are_refused(
    statistic: Callable[..., object],
) -> None:
    with pytest.raises(InputError, match="answered twice"):
        statistic(np.array([1, 2]), np.array(["a", "a"]), np.array(["x", "x"]))


def made(
    people: int = 30, trials: int = 3, noise: float = 0.8, seed: int = 1
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    generator = np.random.default_rng(seed)
    latent = generator.normal(0, 1, people * trials)
    first, again = (
        np.clip(np.rint(latent + generator.normal(0, noise, len(latent))), -2, 2).astype(int)
        for _ in range(2)
    )
    return first, again, np.repeat(np.arange(people), trials)


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


def test_the_same_answers_again_are_full_agreement() -> None:
    first, _, people = made()
    result = retest_agreement(first, first, people)
    assert (result.estimate, result.low, result.high, result.equal_share) == (1, 1, 1, 1)


def test_a_participant_counts_as_one_however_many_trials() -> None:
    first, again, people = made()
    thrice = [np.tile(column, 3) for column in (first, again, people)]
    once, more = retest_agreement(first, again, people), retest_agreement(*thrice)
    assert (more.low, more.high) == pytest.approx((once.low, once.high))
    assert more.n == 3 * once.n


def test_all_alike_has_a_share_but_no_kappa_and_one_side_alike_no_rank_correlation() -> None:
    result = retest_agreement(np.zeros(4, int), np.zeros(4, int), np.arange(4))
    one_side = retest_agreement(np.array([0, 1]), np.array([1, 1]), np.array([0, 1]))
    assert result.equal_share == 1
    assert math.isnan(result.estimate)
    assert math.isnan(one_side.spearman)
    assert one_side.reason == "one side's answers are all alike"
