import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from statsmodels.stats.weightstats import DescrStatsW

from analysis.stats.clustered_mean import Estimate, clustered_mean
from analysis.stats.one_sample_tests import (
    equivalence,
    pooled_tests,
    require_margin,
    sign_test,
    signed_rank,
)
from motion.arrays import Floats
from motion.errors import InputError


def by_all_signs(values: Floats) -> float:
    """Return the exact two-sided p by going through every assignment of signs."""
    kept = values[values != 0]
    ranks = stats.rankdata(np.abs(kept))
    sums = np.array([np.dot(ranks, s) for s in itertools.product([0, 1], repeat=len(ranks))])
    result = ranks[kept > 0].sum()
    centre = ranks.sum() / 2
    return float(np.mean(np.abs(sums - centre) >= abs(result - centre) - 1e-9))


@settings(max_examples=60)
@given(st.lists(st.integers(-3, 3), min_size=1, max_size=9).filter(any))
def test_signed_ranks_with_ties_and_zeros_match_full_enumeration(values: list[float]) -> None:
    # Means that are equal but for rounding are tied.
    rounding = 1e-13 * np.arange(len(values))
    result = signed_rank(np.array(values) / 7 + rounding)
    assert result.p_value == pytest.approx(by_all_signs(np.array(values)))


def test_pooled_tests_equal_the_textbook_tests() -> None:
    answers = np.random.default_rng(1).integers(-2, 3, 600)
    result = pooled_tests(answers)
    wins, losses = int((answers > 0).sum()), int((answers < 0).sum())
    assert result.binomial_p == pytest.approx(stats.binomtest(wins, wins + losses).pvalue)
    plain = stats.wilcoxon(answers.astype(float), correction=False, method="approx")
    assert result.wilcoxon_p == pytest.approx(plain.pvalue)


def test_six_above_and_one_below_worked_by_hand() -> None:
    # The difference of sums is a rounding error, which counts as zero.
    result = sign_test(np.array([0.2, 0.1, 0.5, 0.3, 0.1 + 0.2 - 0.3, 0.4, 0.9, -0.1]))
    assert result.p_value == pytest.approx(2 * (1 + 7) / 2**7)
    assert result.estimate == pytest.approx(6 / 7)
    assert result.low < 0.5 < result.high


def test_equivalence_agrees_with_another_implementation() -> None:
    differences = np.random.default_rng(3).normal(0.1, 0.5, 40)
    expected = DescrStatsW(differences)
    people = clustered_mean(differences, np.arange(40), np.zeros(40), null=0, limits=(-9, 9))
    result = equivalence(people, 0.3)
    assert result.p_value == pytest.approx(expected.ttost_mean(-0.3, 0.3)[0])
    assert (result.low, result.high) == pytest.approx(expected.tconfint_mean(alpha=0.1))
    assert (result.verdict, result.n) == ("equivalent", 40)
    assert result.df == pytest.approx(39)


@pytest.mark.parametrize(
    ("estimate", "error", "verdict"),
    [
        (0.5, 0.1, "equivalent"),
        (0.7, 0.05, "equivalent and different"),
        (1.4, 0.1, "different"),
        (0.7, 0.3, "undecided"),
    ],
)
def test_equivalence_distinguishes_four_cases(estimate: float, error: float, verdict: str) -> None:
    share = Estimate(estimate=estimate, standard_error=error, df=200)
    assert equivalence(share, 0.5, null=0.5).verdict == verdict


@given(st.floats(-2, 2), st.floats(0.01, 2), st.floats(0.01, 2), st.floats(1, 200))
def test_means_are_equivalent_if_the_interval_lies_within_the_margins(
    estimate: float, error: float, margin: float, df: float
) -> None:
    result = equivalence(Estimate(estimate=estimate, standard_error=error, df=df), margin)
    within = -margin < result.low and result.high < margin
    if abs(result.p_value - 0.05) > 1e-9:
        assert within == (result.p_value < 0.05) == result.verdict.startswith("equivalent")


@pytest.mark.parametrize("margin", [0, -0.1, math.nan, math.inf])
def test_a_margin_must_be_positive(margin: float) -> None:
    with pytest.raises(InputError, match="the margin of equivalence is"):
        require_margin(margin)
