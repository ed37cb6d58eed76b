from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from statsmodels.regression.linear_model import OLS
from statsmodels.stats.sandwich_covariance import cov_cluster_2groups

from analysis.clustered_variance import (
    INDEPENDENT,
    ONE_WAY_PARTICIPANTS,
    ONE_WAY_SEGMENTS,
    TWO_WAY,
)
from analysis.preferences.clustered import clustered_mean


def means(rows):
    """Return the estimate for a table of participants (rows) by segments (columns)."""
    table = np.asarray(rows, float)
    people, items = np.indices(table.shape)
    return clustered_mean(table.ravel(), people.ravel(), items.ravel())


def by_hand(values, people, items):
    """Two-way CR1 variance of a mean, written out from Cameron, Gelbach & Miller (2011)."""
    residuals = values - values.mean()

    def one_way(groups):
        sums = [residuals[groups == group].sum() for group in np.unique(groups)]
        return sum(s**2 for s in sums) / len(values) ** 2 * len(sums) / (len(sums) - 1)

    cells = people * (items.max() + 1) + items
    return one_way(people) + one_way(items) - one_way(cells)


def test_a_table_worked_by_hand():
    # Residuals .25 .25 / -.75 .25: each of the three variances is .0625.
    found = means([[1, 1], [0, 1]])
    assert found.estimate == 0.75
    assert found.standard_error == pytest.approx(0.25)
    assert found.method == TWO_WAY
    assert found.p_value == pytest.approx(2 * stats.t(1).sf(1.0))
    assert (found.low, found.high) == (0.0, 1.0)


def test_an_unbalanced_sample_agrees_with_the_formula():
    generator = np.random.default_rng(5)
    people, items = generator.integers(0, 9, 150), generator.integers(0, 7, 150)
    values = (np.sign((people - 4) + (items - 3) + generator.normal(0, 3, 150)) + 1) / 2
    found = clustered_mean(values, people, items)
    assert found.method == TWO_WAY
    assert found.standard_error**2 == pytest.approx(by_hand(values, people, items))
    margin = stats.t(6).ppf(0.975) * found.standard_error
    assert found.low == pytest.approx(found.estimate - margin)
    assert found.high == pytest.approx(found.estimate + margin)


def test_it_agrees_with_another_implementation():
    generator = np.random.default_rng(6)
    people, items = generator.integers(0, 12, 300), generator.integers(0, 9, 300)
    values = (np.sign((people - 6) + (items - 4) + generator.normal(0, 5, 300)) + 1) / 2
    fit = OLS(values, np.ones((300, 1))).fit()
    expected = cov_cluster_2groups(fit, people, items)[0].item()
    assert clustered_mean(values, people, items).standard_error ** 2 == pytest.approx(expected)


def test_an_interval_is_cut_where_values_can_no_longer_lie():
    people, items = np.repeat([0, 1, 2], 3), np.tile([0, 1, 2], 3)
    values = np.array([1, 1, 2, 1, 1, 1, 1, 2, 5])
    found = clustered_mean(values, people, items, null=3, limits=(1, 5))
    assert found.low == 1
    assert found.estimate < found.high < 5


@pytest.mark.parametrize(
    ("rows", "method", "variance"),
    [
        # Person sums .5 and -.5, segment sums 0: two-way 1/36 + 0 - .05 is negative.
        ([[1, 0, 1], [0, 1, 0]], ONE_WAY_PARTICIPANTS, 1 / 36),
        ([[1, 0], [0, 1], [1, 0]], ONE_WAY_SEGMENTS, 1 / 36),
        # All clustered sums are 0: what is left is the variance of independent answers.
        ([[1, 0], [0, 1]], INDEPENDENT, 1 / 12),
    ],
)
def test_a_two_way_variance_below_a_one_way_one_is_replaced_and_says_so(rows, method, variance):
    found = means(rows)
    assert found.method == method
    assert found.standard_error**2 == pytest.approx(variance)


@pytest.mark.parametrize(
    ("rows", "reason"),
    [
        ([[1, 0, 0.5]], "one participant"),
        ([[1], [0], [0.5]], "one segment"),
        ([[1, 1], [1, 1]], "all answers alike"),
        ([[0.5, 0.5], [0.5, 0.5]], "all answers alike"),
    ],
)
def test_a_design_too_small_gives_no_interval_but_a_reason(rows, reason):
    found = means(rows)
    assert found.reason == reason
    assert found.estimate == pytest.approx(np.mean(rows))
    assert math.isnan(found.low)
    assert math.isnan(found.high)
    assert math.isnan(found.p_value)
    assert not found.method


def test_no_answers_give_no_number_at_all():
    found = clustered_mean(np.zeros(0), np.zeros(0, str), np.zeros(0, str))
    assert found.reason == "no answers"
    assert math.isnan(found.estimate)
    assert (found.answers, found.participants, found.segments) == (0, 0, 0)


tables = st.integers(2, 6).flatmap(
    lambda width: st.lists(
        st.lists(st.sampled_from([0.0, 0.5, 1.0]), min_size=width, max_size=width),
        min_size=2,
        max_size=6,
    )
)


@given(tables)
def test_turning_every_answer_round_mirrors_the_interval(rows):
    found, mirrored = means(rows), means(1 - np.asarray(rows))
    assert mirrored.estimate == pytest.approx(1 - found.estimate)
    assert mirrored.reason == found.reason
    if not found.reason:
        assert mirrored.low == pytest.approx(1 - found.high)
        assert mirrored.p_value == pytest.approx(found.p_value)


@given(tables)
def test_an_interval_lies_in_the_unit_range_around_its_estimate(rows):
    found = means(rows)
    if not found.reason:
        assert 0 <= found.low <= found.estimate <= found.high <= 1
        assert found.low < found.high
        assert 0 <= found.p_value <= 1


def test_names_and_order_of_clusters_do_not_matter():
    generator = np.random.default_rng(2)
    values = generator.choice([0, 0.5, 1], 60)
    people, items = np.repeat(np.arange(10), 6), np.tile(np.arange(6), 10)
    order = generator.permutation(60)
    plain = clustered_mean(values, people, items)
    named = clustered_mean(values[order], (people[order] * -7).astype(str), items[order] + 100)
    assert named.standard_error == pytest.approx(plain.standard_error)
