import math
from typing import Any

import numpy as np
import pytest
from scipy import stats

from analysis.results.against_people import MetricAgainstPeople, against_people
from analysis.results.rank_correlations import (
    Kind,
    compatible,
    kendall,
    order_signs,
    sampling_range,
    spearman,
)
from tests.analysis.results.simulated_studies import AgreeingStudy


def against(resamples: int = 50, **settings: Any) -> MetricAgainstPeople:
    study = AgreeingStudy(**settings).drawn(np.random.default_rng(1))
    return against_people("rating", *study, resamples=resamples).metrics[0]


def test_a_metric_that_orders_conditions_as_people_do_correlates_perfectly() -> None:
    result = against(100, tau=1.0, noise=0.0, within=1.0)
    assert result.kendall.estimate == result.spearman.estimate == 1
    assert result.kendall.low < 1
    assert result.kendall.high == 1
    assert result.within.estimate == pytest.approx(1)


@pytest.mark.parametrize(
    ("settings", "has_estimate", "reason"),
    [
        ({"conditions": 2}, False, "2 conditions have scores and answers; a correlation needs 3"),
        ({"conditions": 3}, True, "3 conditions are too few for an interval"),
        ({"participants": 1}, True, "one participant: it is unknown how people differ"),
    ],
)
def test_too_few_conditions_give_a_reason_instead_of_an_interval(
    settings: dict[str, int], has_estimate: bool, reason: str
) -> None:
    result = against(**settings).kendall
    assert math.isnan(result.estimate) != has_estimate
    assert math.isnan(result.low)
    assert result.reason == reason


def test_resamples_without_a_correlation_are_counted() -> None:
    # All four draws are one condition with a chance of 4 in 4⁴.
    assert 10 < against(2000, conditions=4).kendall.degenerate < 60


def test_scores_far_from_zero_correlate_alike_within_conditions() -> None:
    shifted = against(within=0.5, offset=1e6).within
    assert shifted.estimate == pytest.approx(against(within=0.5).within.estimate, rel=1e-6)


@pytest.mark.slow
def test_intervals_contain_the_truth_at_least_as_often_as_they_say() -> None:
    """Also where six conditions are few, and their scores and answers noisy."""
    study = AgreeingStudy(conditions=6, tau=0.5, within=0.3)
    truth = 0.3 * math.sqrt(0.25 / (0.25 + study.noise**2 / study.participants))
    chance = np.random.default_rng(11)
    over, within = [], []
    for _ in range(60):
        result = against_people("rating", *study.drawn(chance), resamples=200).metrics[0]
        over.append(result.kendall.low <= study.tau <= result.kendall.high)
        within.append(result.within.low <= truth <= result.within.high)
    assert np.mean(over) >= 0.93
    # 88 of 100 is what 93 of 100 may come to in 60 studies.
    assert np.mean(within) >= 0.88


ONCE = np.ones(5, int)


@pytest.mark.parametrize(
    ("second", "times"),
    [
        ([5, 3, 4, 1, 2], ONCE),
        ([1, 1, 2, 2, 2], ONCE),
        # Drawn twice is counted twice, and tied with itself.
        ([3, 1, 1, 4, 5], np.array([2, 0, 1, 3, 1])),
        # Equal but for rounding.
        ([0.1 + 0.2, 0.3, 0.4, 0.1, 0.2], ONCE),
    ],
)
def test_both_correlations_agree_with_scipy_with_ties_and_weights(
    second: list[float], times: np.ndarray
) -> None:
    first = np.array([1.0, 2.0, 2.0, 4.0, 5.0])
    signs = order_signs(first[None]), order_signs(np.array([second]))
    drawn = np.repeat(first, times), np.repeat(np.round(second, 9), times)
    weights = times[None].astype(float)
    assert kendall(*signs, weights)[0] == pytest.approx(stats.kendalltau(*drawn).statistic)
    assert spearman(*signs, weights)[0] == pytest.approx(stats.spearmanr(*drawn).statistic)


def test_with_ten_conditions_a_true_half_varies_from_nearly_none_to_nearly_one() -> None:
    result = sampling_range(10)
    assert (round(result.low, 2), round(result.high, 2)) == (0.07, 0.82)


def test_a_perfect_order_excludes_zero_with_ten_conditions_but_not_with_four() -> None:
    low, high = compatible(1.0, 4, "kendall")
    assert low < 0
    assert high == 1
    assert compatible(1.0, 10, "kendall")[0] > 0.7


@pytest.mark.parametrize("kind", ["kendall", "spearman"])
def test_compatible_correlations_surround_the_estimate_and_mirror_with_it(kind: Kind) -> None:
    low, high = compatible(0.4, 6, kind)
    assert low < 0.4 < high
    assert compatible(-0.4, 6, kind) == (-high, -low)
