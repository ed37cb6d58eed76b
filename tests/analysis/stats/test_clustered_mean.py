import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from scipy import stats
from statsmodels.regression.linear_model import OLS
from statsmodels.stats.sandwich_covariance import cov_cluster_2groups

from analysis.stats.clustered_mean import (
    INDEPENDENT,
    ONE_SEGMENT,
    ONE_WAY_PARTICIPANTS,
    ONE_WAY_SEGMENTS,
    TWO_WAY,
    Estimate,
    clustered_mean,
)
from motion.arrays import Floats, Indices
from tests.analysis.stats.tables import cells


def means(rows: ArrayLike) -> Estimate:
    """Return the estimate for a table of participants (rows) by segments (columns)."""
    return clustered_mean(*cells(rows))


def by_matrices(values: Floats, people: Indices, items: Indices) -> tuple[float, float]:
    """CR2 and Bell & McCaffrey's degrees of freedom of an intercept, written out as matrices."""
    count = len(values)
    design = np.ones((count, 1))
    hat = design @ design.T / count
    annihilator = np.eye(count) - hat

    def one_way(groups: Indices) -> tuple[float, float]:
        variance, columns = 0.0, []
        for group in np.unique(groups):
            own = np.flatnonzero(groups == group)
            scale, axes = np.linalg.eigh(np.eye(len(own)) - hat[np.ix_(own, own)])
            adjusted = axes @ np.diag(scale**-0.5) @ axes.T
            variance += (adjusted @ (values - values.mean())[own]).sum() ** 2 / count**2
            columns.append(annihilator[:, own] @ adjusted @ np.ones(len(own)) / count)
        gram = np.array(columns) @ np.array(columns).T
        return variance, np.trace(gram) ** 2 / (gram**2).sum()

    by_people, by_items = one_way(people), one_way(items)
    by_cell, _ = one_way(people * (items.max() + 1) + items)
    return by_people[0] + by_items[0] - by_cell, min(by_people[1], by_items[1])


def test_an_unbalanced_sample_agrees_with_the_formula() -> None:
    generator = np.random.default_rng(5)
    people, items = generator.integers(0, 9, 150), generator.integers(0, 7, 150)
    values = (np.sign((people - 4) + (items - 3) + generator.normal(0, 3, 150)) + 1) / 2
    people[:60] = 0
    result = clustered_mean(values, people.astype(str), items + 100)
    variance, freedom = by_matrices(values, people, items)
    assert result.method == TWO_WAY
    assert result.standard_error**2 == pytest.approx(variance)
    assert result.df == pytest.approx(freedom)
    margin = stats.t(freedom).ppf(0.975) * result.standard_error
    assert result.low == pytest.approx(result.estimate - margin)
    assert result.high == pytest.approx(result.estimate + margin)


def test_a_balanced_sample_gives_the_plain_two_way_variance() -> None:
    generator = np.random.default_rng(6)
    people, items = np.repeat(np.arange(12), 27), np.tile(np.arange(9), 36)
    values = (np.sign((people - 6) + (items - 4) + generator.normal(0, 5, 324)) + 1) / 2
    fit = OLS(values, np.ones((324, 1))).fit()
    expected = cov_cluster_2groups(fit, people, items)[0].item()
    assert clustered_mean(values, people, items).standard_error ** 2 == pytest.approx(expected)


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
def test_a_two_way_variance_below_a_one_way_one_is_replaced_with_a_note(
    rows: list[list[float]], method: str, variance: float
) -> None:
    result = means(rows)
    assert result.method == method
    assert result.standard_error**2 == pytest.approx(variance)


def test_with_one_segment_only_participants_are_sampled() -> None:
    result = means([[1], [0], [1], [1]])
    assert result.method == ONE_SEGMENT
    assert result.p_value == pytest.approx(stats.ttest_1samp([1, 0, 1, 1], 0.5).pvalue)


def test_a_dominant_participant_costs_degrees_of_freedom_and_is_named() -> None:
    generator = np.random.default_rng(8)
    people = np.concatenate([np.zeros(300, int), generator.integers(1, 30, 210)])
    values = np.where(people == 0, generator.random(510) < 0.7, generator.random(510) < 0.5)
    result = clustered_mean(values.astype(float), people, generator.integers(0, 17, 510))

    without = [values[people != one].mean() for one in np.unique(people)]
    assert result.df < 4
    assert result.remark == (
        "one participant gave 300 of 510 answers; without any one participant the estimate lies "
        f"between {min(without):.3g} and {max(without):.3g}"
    )


tables = st.integers(2, 6).flatmap(
    lambda width: st.lists(
        st.lists(st.sampled_from([0.0, 0.5, 1.0]), min_size=width, max_size=width),
        min_size=2,
        max_size=6,
    )
)


@given(tables)
def test_an_interval_of_shares_stays_in_range_and_mirrors_with_the_answers(
    rows: list[list[float]],
) -> None:
    result, mirrored = means(rows), means(1 - np.asarray(rows))
    assert result.estimate == pytest.approx(np.mean(rows))
    assert mirrored.estimate == pytest.approx(1 - result.estimate)
    assert mirrored.reason == result.reason
    if not result.reason:
        assert mirrored.low == pytest.approx(1 - result.high)
        assert mirrored.p_value == pytest.approx(result.p_value)
        assert 0 <= result.low <= result.estimate <= result.high <= 1
        assert result.low < result.high
        assert 0 <= result.p_value <= 1


def test_identical_participants_on_one_segment_give_no_clustering() -> None:
    values, people = np.array([0.0, 1, 0, 1]), np.array([0, 0, 1, 1])
    result = clustered_mean(values, people, np.zeros(4))
    assert result.method == INDEPENDENT
    assert result.standard_error == pytest.approx(np.std(values, ddof=1) / 2)
