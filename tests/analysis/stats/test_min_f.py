from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from analysis.stats.min_f import min_f


def outcome(table):
    table = np.asarray(table, float)
    people, items = np.indices(table.shape)
    return min_f(table.ravel(), people.ravel(), items.ravel())


def test_it_is_made_of_the_two_t_tests():
    generator = np.random.default_rng(7)
    table = 0.4 + generator.normal(0, 0.5, (20, 1)) + generator.normal(0, 1, (20, 12))
    found = outcome(table)
    f1 = stats.ttest_1samp(table.mean(axis=1), 0).statistic ** 2
    f2 = stats.ttest_1samp(table.mean(axis=0), 0).statistic ** 2
    assert found.f_participants == pytest.approx(f1)
    assert found.f_items == pytest.approx(f2)
    assert found.statistic == pytest.approx(f1 * f2 / (f1 + f2))
    assert found.df_rest == pytest.approx((f1 + f2) ** 2 / (f1**2 / 11 + f2**2 / 19))
    assert found.p_value == pytest.approx(stats.f.sf(found.statistic, 1, found.df_rest))
    assert found.statistic < min(f1, f2)


def test_an_unbalanced_sample_counts_every_participant_and_item_once():
    values = np.array([1.0, 1, 1, 0, 2, 1])
    people, items = np.array([0, 0, 0, 0, 1, 1]), np.array([0, 0, 0, 1, 0, 1])
    found = min_f(values, people, items)
    assert found.f_participants == pytest.approx(stats.ttest_1samp([0.75, 1.5], 0).statistic ** 2)
    assert found.estimate == 1.0


def test_participants_all_alike_leave_the_test_to_the_items():
    found = outcome([[1, 2, 0], [1, 2, 0], [0, 2, 1]])
    assert math.isinf(found.f_participants)
    assert found.statistic == pytest.approx(found.f_items)
    assert found.df_rest == pytest.approx(2)


def test_a_mean_of_zero_is_no_effect():
    found = outcome([[1, -1, 0], [0, 1, -1]])
    assert (found.statistic, found.p_value, found.reason) == (0.0, 1.0, "")
    assert found.low == pytest.approx(-found.high)


@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_the_interval_and_the_test_say_the_same(shift):
    generator = np.random.default_rng(11)
    table = shift + generator.normal(0, 0.3, (18, 1)) + generator.normal(0, 1, (18, 14))
    for end in (outcome(table).low, outcome(table).high):
        assert outcome(table - end).p_value == pytest.approx(0.05, abs=1e-6)


def test_it_is_conservative_without_an_effect():
    generator = np.random.default_rng(3)
    found = [
        outcome(
            generator.normal(0, 0.6, (15, 1))
            + generator.normal(0, 0.4, (1, 10))
            + generator.normal(0, 1, (15, 10))
        ).p_value
        for _ in range(200)
    ]
    assert np.mean(np.array(found) < 0.05) <= 0.065


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ([[1, 0, 1]], "one participant"),
        ([[1], [0]], "one segment"),
        ([[0, 0], [0, 0]], "all answers are zero"),
        ([[1, 1], [1, 1]], "all answers alike"),
        (np.zeros((0, 2)), "no answers"),
    ],
)
def test_no_test_comes_with_its_reason(table, reason):
    found = outcome(table)
    assert found.reason == reason
    assert math.isnan(found.p_value)
