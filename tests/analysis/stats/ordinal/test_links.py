from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from analysis.stats.ordinal.links import Link, Structure, Thresholds, interval

LAWS = {"logit": stats.logistic, "probit": stats.norm}
ENDS = (
    np.array([-np.inf, -3.0, -0.2, 1.0, 4.0]),
    np.array([-1.0, -2.5, 0.3, 2.0, np.inf]),
)
STEP = 1e-5

STRUCTURES: tuple[Structure, ...] = ("flexible", "symmetric", "symmetric around zero")


@pytest.mark.parametrize("link", ["logit", "probit"])
def test_the_probability_is_that_of_the_interval(link: Link) -> None:
    lower, upper = ENDS

    found = interval(lower, upper, link)

    np.testing.assert_allclose(
        np.exp(found.log_probability), LAWS[link].cdf(upper) - LAWS[link].cdf(lower), rtol=1e-12
    )


@pytest.mark.parametrize("link", ["logit", "probit"])
@pytest.mark.parametrize("moved", ["eta", "upper", "lower"])
def test_derivatives_are_those_of_the_probability(link: Link, moved: str) -> None:
    lower, upper = ENDS
    shifts = {"eta": (-STEP, -STEP), "upper": (0.0, STEP), "lower": (STEP, 0.0)}
    low, high = shifts[moved]
    ahead = interval(lower + low, upper + high, link)
    behind = interval(lower - low, upper - high, link)
    here = interval(lower, upper, link)

    found = {
        "eta": (here.slope, -here.weights, here.weight_slope),
        "upper": here.by_upper,
        "lower": here.by_lower,
    }[moved]

    before = ("log_probability", "slope", "weights")
    for name, derivative in zip(before, found, strict=True):
        differences = (getattr(ahead, name) - getattr(behind, name)) / (2 * STEP)
        np.testing.assert_allclose(derivative, differences, atol=1e-6)


@pytest.mark.parametrize("link", ["logit", "probit"])
@pytest.mark.parametrize("far", [-30.0, 30.0])
def test_far_intervals_keep_their_digits(link: Link, far: float) -> None:
    law = LAWS[link]
    ends = np.array([far]), np.array([far + 1])
    mirrored = sorted((-abs(far), -abs(far) + np.sign(-far)))

    found = interval(*ends, link)

    expected = np.log(law.cdf(mirrored[1]) - law.cdf(mirrored[0]))
    np.testing.assert_allclose(found.log_probability, expected, rtol=1e-9)


@given(st.data(), st.integers(2, 8), st.sampled_from(STRUCTURES))
def test_thresholds_are_always_in_order(
    data: st.DataObject, categories: int, structure: Structure
) -> None:
    thresholds = Thresholds(categories, structure)
    numbers = st.floats(-3, 3)
    free = data.draw(st.lists(numbers, min_size=thresholds.count, max_size=thresholds.count))

    values = thresholds.values(np.array(free))

    assert values.shape == (categories - 1,)
    assert (np.diff(values) > 0).all()
    if structure != "flexible":
        middle = (values + values[::-1]) / 2
        np.testing.assert_allclose(middle, middle[0], atol=1e-9)
    if structure == "symmetric around zero":
        np.testing.assert_allclose(values, -values[::-1], atol=1e-9)


@pytest.mark.parametrize("structure", STRUCTURES)
def test_the_jacobian_is_the_derivative(structure: Structure) -> None:
    thresholds = Thresholds(5, structure)
    free = np.linspace(-0.4, 0.3, thresholds.count)
    steps = 1e-6 * np.eye(thresholds.count)

    numeric = [(thresholds.values(free + e) - thresholds.values(free - e)) / 2e-6 for e in steps]

    np.testing.assert_allclose(thresholds.jacobian(free), np.transpose(numeric), atol=1e-8)


def test_it_starts_where_the_counts_are_met() -> None:
    thresholds = Thresholds(3)

    values = thresholds.values(thresholds.start(np.array([25, 50, 25])))

    np.testing.assert_allclose(values, [-np.log(3), np.log(3)], atol=0.05)
