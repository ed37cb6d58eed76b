from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import expit
from scipy.stats import logistic

from analysis.stats.ordinal.crossed import Information, Layout
from analysis.stats.ordinal.laplace import Answers, Interval, Thresholds, likelihood
from tests.analysis.stats.ordinal.made_answers import made_answers


def test_the_gradient_is_the_derivative() -> None:
    made = made_answers()
    answers = Answers(
        codes=made.values,
        thresholds=Thresholds(5),
        fixed=made.side[:, None],
        layout=Layout((made.participants, made.participants, made.items), (20, 20, 12)),
        multipliers=(made.side, np.ones_like(made.side), made.side),
    )
    at = np.random.default_rng(2).normal(0, 0.4, answers.count)

    numeric = [
        (likelihood(answers, at + e).value - likelihood(answers, at - e).value) / 2e-5
        for e in 1e-5 * np.eye(answers.count)
    ]

    np.testing.assert_allclose(likelihood(answers, at).gradient, numeric, rtol=1e-5, atol=1e-5)


def test_the_approximation_is_near_the_exact_integral() -> None:
    codes = np.array([0, 1, 1, 0, 1, 1, 1, 0] * 5)
    layout = Layout((np.zeros(40, int),), (1,))
    made = Answers(codes, Thresholds(2), np.empty((40, 0)), layout, (np.ones(40),))

    def density(u: float) -> float:
        right = expit(np.where(codes == 1, u * 0.7 - 0.2, 0.2 - u * 0.7))
        return float(np.prod(right) * np.exp(-0.5 * u * u) / np.sqrt(2 * np.pi))

    exact = np.log(quad(density, -8, 8)[0])
    assert likelihood(made, np.array([0.2, 0.7])).value == pytest.approx(exact, abs=0.02)


@pytest.mark.parametrize("sizes", [(7,), (7, 4, 3)])
def test_the_information_agrees_with_the_full_matrix(sizes: tuple[int, ...]) -> None:
    chance = np.random.default_rng(3)
    groups = tuple(chance.integers(0, size, 60) for size in sizes)
    multipliers = [chance.normal(size=60) for _ in sizes]
    weights = chance.uniform(0.1, 1, 60)
    design = np.concatenate(
        [m[:, None] * np.eye(k)[g] for m, k, g in zip(multipliers, sizes, groups, strict=True)],
        axis=1,
    )
    matrix = np.eye(sum(sizes)) + design.T @ (weights[:, None] * design)
    right = chance.normal(size=sum(sizes))

    information = Information.of(Layout(groups, sizes), multipliers, weights)

    np.testing.assert_allclose(information.log_determinant, np.linalg.slogdet(matrix)[1])
    np.testing.assert_allclose(information.solve(right), np.linalg.solve(matrix, right))
    variances = sum(
        m * d for m, d in zip(multipliers, information.directions(multipliers), strict=True)
    )
    expected = np.einsum("ij,jk,ik->i", design, np.linalg.inv(matrix), design)
    np.testing.assert_allclose(variances, expected)


@pytest.mark.parametrize("far", [-30.0, 30.0])
def test_probabilities_of_extreme_intervals_stay_accurate(far: float) -> None:
    low, high = sorted((-abs(far), -abs(far) + np.sign(-far)))

    result = Interval(np.array([far]), np.array([far + 1]))

    expected = np.log(logistic.cdf(high) - logistic.cdf(low))
    np.testing.assert_allclose(result.log_probability, expected, rtol=1e-9)


@given(st.lists(st.floats(-3, 3), min_size=1, max_size=7))
def test_thresholds_are_always_in_order(free: list[float]) -> None:
    thresholds = Thresholds(len(free) + 1)

    values = thresholds.values(np.array(free))

    assert (np.diff(values) > 0).all()
