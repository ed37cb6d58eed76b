from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from analysis.stats.ordinal.links import Link, interval

LAWS = {"logit": stats.logistic, "probit": stats.norm}
ENDS = (
    np.array([-np.inf, -3.0, -0.2, 1.0, 4.0]),
    np.array([-1.0, -2.5, 0.3, 2.0, np.inf]),
)
STEP = 1e-5


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
