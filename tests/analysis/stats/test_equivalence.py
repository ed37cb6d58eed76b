from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from statsmodels.stats.weightstats import DescrStatsW

from analysis.stats.one_sample_tests import equivalence, equivalence_of_means
from motion.errors import InputError


def test_it_agrees_with_another_implementation() -> None:
    differences = np.random.default_rng(3).normal(0.1, 0.5, 40)
    expected = DescrStatsW(differences)
    result = equivalence_of_means(differences, 0.3)
    assert result.p_value == pytest.approx(expected.ttost_mean(-0.3, 0.3)[0])
    assert (result.low, result.high) == pytest.approx(expected.tconfint_mean(alpha=0.1))
    assert (result.verdict, result.n, result.df) == ("equivalent", 40, 39)


@pytest.mark.parametrize(
    ("estimate", "error", "verdict"),
    [
        (0.0, 0.1, "equivalent"),
        (0.2, 0.05, "equivalent and different"),
        (0.9, 0.1, "different"),
        (0.2, 0.3, "undecided"),
    ],
)
def test_it_tells_four_cases_apart(estimate: float, error: float, verdict: str) -> None:
    assert equivalence(estimate, error, 0.5).verdict == verdict


@given(st.floats(-2, 2), st.floats(0.01, 2), st.floats(0.01, 2), st.floats(1, 200))
def test_it_is_equivalent_where_the_interval_lies_within_the_margins(
    estimate: float, error: float, margin: float, df: float
) -> None:
    result = equivalence(estimate, error, margin, df=df)
    within = -margin < result.low and result.high < margin
    if abs(result.p_value - 0.05) > 1e-9:
        assert within == (result.p_value < 0.05) == result.verdict.startswith("equivalent")


@pytest.mark.parametrize("margin", [0, -0.1, math.nan, math.inf])
def test_a_margin_that_is_not_above_zero_is_refused(margin: float) -> None:
    with pytest.raises(InputError, match="the margin of equivalence is"):
        equivalence(0.0, 0.1, margin)
