from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from analysis.results.against_people.people_side import (
    PSEUDO_VOTES,
    drawn_preferences,
    drawn_strengths,
    tallies,
)
from analysis.stats.two_way_bootstrap import bootstrap_means, cells_of
from tests.analysis.results.against_people.simulated_studies import AgreeingStudy


@pytest.fixture
def answers():
    return AgreeingStudy(conditions=3).drawn(np.random.default_rng(1))[0]


def test_estimates_are_the_means(answers):
    found = drawn_preferences(tallies("rating", answers), resamples=10, seed=0)
    means = answers.groupby("condition", observed=True)["value"].mean()
    assert found.estimates == pytest.approx(means.to_numpy())


def test_resamples_are_those_of_the_two_way_bootstrap(answers):
    one = answers[answers["condition"] == "c01"]
    cells = cells_of(
        one["value"].to_numpy(), one["participant"].to_numpy(), one["segment"].to_numpy()
    )
    expected = bootstrap_means(cells, resamples=500, seed=4)[:, 0]
    found = drawn_preferences(tallies("rating", answers), resamples=500, seed=4)
    assert found.draws[:, 1] == pytest.approx(expected)
    assert found.segments.sum(axis=1) == pytest.approx(12)


def test_one_seed_gives_one_result(answers):
    first, again = (
        drawn_preferences(tallies("rating", answers), resamples=50, seed=2) for _ in range(2)
    )
    assert np.array_equal(first.draws, again.draws)


def test_strengths_have_the_greatest_likelihood():
    chance = np.random.default_rng(3)
    wins = chance.integers(1, 30, (4, 4)).astype(float)
    np.fill_diagonal(wins, 0)
    padded = wins + PSEUDO_VOTES * (1 - np.eye(4))

    def loss(strengths: np.ndarray) -> float:
        apart = strengths[:, None] - strengths[None]
        return float((padded * np.logaddexp(0, -apart)).sum() + strengths.sum() ** 2)

    best = minimize(loss, np.zeros(4), tol=1e-12).x
    assert drawn_strengths(wins[None])[0] == pytest.approx(best, abs=1e-5)


def test_a_condition_that_always_wins_is_strong_but_finite():
    wins = np.array([[0, 500.0, 500], [0, 0, 300], [0, 200, 0]])
    found = drawn_strengths(wins[None])[0]
    assert np.isfinite(found).all()
    assert found[0] > found[1] > found[2]
    assert found.sum() == pytest.approx(0)


def test_conditions_that_no_comparison_connects_have_no_strengths():
    apart = np.zeros((2, 4, 4))
    apart[:, 0, 1] = apart[:, 2, 3] = 5
    apart[1, 1, 2] = 1
    found = drawn_strengths(apart)
    assert np.isnan(found[0]).all()
    assert np.isfinite(found[1]).all()
