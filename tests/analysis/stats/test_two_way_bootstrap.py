from __future__ import annotations

import numpy as np
import pytest

from analysis.stats.two_way_bootstrap import bootstrap_means, cells_of, percentile_interval


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

    monkeypatch.setattr("analysis.stats.two_way_bootstrap.FULL", 2.0)

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
    assert percentile_interval(np.arange(101.0), 0.9) == pytest.approx((5.0, 95.0))


def test_the_same_seed_draws_the_same() -> None:
    cells = cells_of(*made())

    assert (bootstrap_means(cells, seed=3) == bootstrap_means(cells, seed=3)).all()
    assert (bootstrap_means(cells, seed=3) != bootstrap_means(cells, seed=4)).any()
