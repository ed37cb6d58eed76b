import numpy as np
import pytest
from scipy.optimize import minimize

from analysis.results.against_people.drawn_strengths import PSEUDO_VOTES, drawn_strengths


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
