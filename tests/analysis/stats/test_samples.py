from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from analysis.stats.agreement import krippendorff_alpha
from analysis.stats.equivalence import equivalence_of_means
from analysis.stats.f_tests import min_f
from analysis.stats.intraclass import intraclass_correlation
from analysis.stats.ratings import cliffs_delta
from analysis.stats.samples import (
    bootstrap_means,
    cells_of,
    finite,
    group_means,
    levels,
    percentile_interval,
    tied_ranks,
)
from analysis.stats.signed_rank import pooled_tests, sign_test, signed_rank
from motion.errors import InputError

GAP = np.array([1.0, np.nan, 2.0, 1.0])
WHO, WHAT = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])


def test_numbers_pass_as_floats() -> None:
    assert finite(np.array([1, 2])).dtype == np.float64
    assert finite(np.zeros((0, 3))).shape == (0, 3)


@pytest.mark.parametrize(
    "statistic",
    [
        finite,
        signed_rank,
        sign_test,
        pooled_tests,
        lambda values: min_f(values, WHO, WHAT),
        lambda values: equivalence_of_means(values, 0.3),
        lambda values: krippendorff_alpha(values, WHO, WHAT),
        lambda values: intraclass_correlation(values, WHO, WHAT),
        lambda values: cliffs_delta(values, WHAT == 0, WHO, WHAT),
    ],
)
def test_a_missing_value_is_named_and_never_becomes_a_number(
    statistic: Callable[[NDArray[np.float64]], object],
) -> None:
    with pytest.raises(InputError, match="value 2 of 4 is missing"):
        statistic(GAP)


def test_everybody_counts_once_however_many_answers() -> None:
    values, people = np.array([1.0, 0, 1, 1]), np.array(["b", "a", "b", "b"])
    assert group_means(values, people).tolist() == [0, 1]
    assert group_means(np.zeros(0), np.zeros(0, str)).tolist() == []


def test_numbers_equal_but_for_rounding_are_tied() -> None:
    thirds = np.array([0.1 + 0.2, 0.3, 1 / 3, 1 - 2 / 3])
    assert levels(thirds).tolist() == [0, 0, 1, 1]
    assert tied_ranks(thirds).tolist() == [1.5, 1.5, 3.5, 3.5]


def test_rows_are_ranked_apart() -> None:
    assert tied_ranks(np.array([[3.0, 1.0, 2.0], [5.0, 5.0, 9.0]])).tolist() == [
        [3, 1, 2],
        [1.5, 1.5, 3],
    ]


def test_nothing_has_no_ranks() -> None:
    assert tied_ranks(np.zeros(0)).tolist() == []
    assert tied_ranks(np.zeros(3)).tolist() == [2, 2, 2]


def made(participants: int = 30, items: int = 20, seed: int = 0) -> tuple[np.ndarray, ...]:
    chance = np.random.default_rng(seed)
    who, what = (
        part.ravel()
        for part in np.meshgrid(np.arange(participants), np.arange(items), indexing="ij")
    )
    values = chance.normal(0, 1, participants)[who] + chance.normal(0, 0.5, items)[what]
    return values + chance.normal(size=len(who)), who, what


def test_it_draws_what_an_index_gather_draws() -> None:
    values, who, what = made()
    cells = cells_of(values, who, what)
    chance = np.random.default_rng(7)
    table = np.zeros((30, 20))
    table[who, what] = values

    people = chance.integers(30, size=(500, 30))
    things = chance.integers(20, size=(500, 20))
    gathered = [table[np.ix_(p, t)].mean() for p, t in zip(people, things, strict=True)]

    assert bootstrap_means(cells, resamples=500, seed=7)[:, 0] == pytest.approx(gathered)


def test_its_spread_is_that_of_both_samples_together() -> None:
    values, who, what = made(participants=60, items=60)

    draws = bootstrap_means(cells_of(values, who, what), resamples=4000)[:, 0]

    assert draws.mean() == pytest.approx(values.mean(), abs=0.02)
    # Both means vary by their own errors, and the noise of a cell counts three times.
    assert draws.var() == pytest.approx(1 / 60 + 0.25 / 60 + 3 / 3600, rel=0.35)


def test_a_table_with_few_filled_cells_gives_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    values, who, what = made()
    whole = bootstrap_means(cells_of(values, who, what), resamples=50)

    monkeypatch.setattr("analysis.stats.samples.FULL", 2.0)

    assert bootstrap_means(cells_of(values, who, what), resamples=50) == pytest.approx(whole)


def test_several_columns_are_drawn_together() -> None:
    values, who, what = made()

    draws = bootstrap_means(cells_of(np.column_stack([values, 2 * values]), who, what))

    assert draws.shape == (10_000, 2)
    assert draws[:, 1] == pytest.approx(2 * draws[:, 0])


def test_answers_of_an_incomplete_design_keep_their_weight() -> None:
    values = np.array([1.0, 1.0, 0.0])
    cells = cells_of(values, np.array(["p", "p", "q"]), np.array(["a", "a", "b"]))

    draws = bootstrap_means(cells, resamples=200)[:, 0]

    known = draws[~np.isnan(draws)]
    assert set(known) <= {0.0, 1.0, 2 / 3}
    assert np.isnan(draws).any()


def test_the_interval_holds_the_middle_of_the_draws() -> None:
    assert percentile_interval(np.arange(101.0)) == pytest.approx((2.5, 97.5))


def test_the_same_seed_draws_the_same() -> None:
    cells = cells_of(*made())

    assert (bootstrap_means(cells, seed=3) == bootstrap_means(cells, seed=3)).all()
    assert (bootstrap_means(cells, seed=3) != bootstrap_means(cells, seed=4)).any()
