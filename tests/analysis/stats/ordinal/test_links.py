from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import logistic

from analysis.stats.ordinal.links import Interval, Thresholds

ENDS = (
    np.array([-np.inf, -3.0, -0.2, 1.0, 4.0]),
    np.array([-1.0, -2.5, 0.3, 2.0, np.inf]),
)
STEP = 1e-5


def test_the_probability_is_that_of_the_interval() -> None:
    lower, upper = ENDS

    result = Interval(lower, upper)

    np.testing.assert_allclose(
        np.exp(result.log_probability), logistic.cdf(upper) - logistic.cdf(lower), rtol=1e-12
    )


@pytest.mark.parametrize("moved", ["eta", "upper", "lower"])
def test_derivatives_are_those_of_the_probability(moved: str) -> None:
    lower, upper = ENDS
    shifts = {"eta": (-STEP, -STEP), "upper": (0.0, STEP), "lower": (STEP, 0.0)}
    low, high = shifts[moved]
    ahead = Interval(lower + low, upper + high)
    behind = Interval(lower - low, upper - high)
    here = Interval(lower, upper)

    result = {
        "eta": (here.slope, -here.weights, here.weight_slope),
        "upper": here.by_upper,
        "lower": here.by_lower,
    }[moved]

    before = ("log_probability", "slope", "weights")
    for name, derivative in zip(before, result, strict=True):
        differences = (getattr(ahead, name) - getattr(behind, name)) / (2 * STEP)
        np.testing.assert_allclose(derivative, differences, atol=1e-6)


@pytest.mark.parametrize("far", [-30.0, 30.0])
def test_far_intervals_keep_their_digits(far: float) -> None:
    ends = np.array([far]), np.array([far + 1])
    mirrored = sorted((-abs(far), -abs(far) + np.sign(-far)))

    result = Interval(*ends)

    expected = np.log(logistic.cdf(mirrored[1]) - logistic.cdf(mirrored[0]))
    np.testing.assert_allclose(result.log_probability, expected, rtol=1e-9)


@given(st.data(), st.integers(2, 8))
def test_thresholds_are_always_in_order(data: st.DataObject, categories: int) -> None:
    thresholds = Thresholds(categories)
    numbers = st.floats(-3, 3)
    free = data.draw(st.lists(numbers, min_size=thresholds.count, max_size=thresholds.count))

    values = thresholds.values(np.array(free))

    assert values.shape == (categories - 1,)
    assert (np.diff(values) > 0).all()
    np.testing.assert_allclose(thresholds.values(thresholds.parameters(values)), values, atol=1e-9)


def test_the_jacobian_is_the_derivative() -> None:
    thresholds = Thresholds(5)
    free = np.linspace(-0.4, 0.3, thresholds.count)
    steps = 1e-6 * np.eye(thresholds.count)

    numeric = [(thresholds.values(free + e) - thresholds.values(free - e)) / 2e-6 for e in steps]

    np.testing.assert_allclose(thresholds.jacobian(free), np.transpose(numeric), atol=1e-8)


def test_it_starts_where_the_counts_are_met() -> None:
    thresholds = Thresholds(3)

    values = thresholds.values(thresholds.start(np.array([25, 50, 25])))

    np.testing.assert_allclose(values, [-np.log(3), np.log(3)], atol=0.05)
