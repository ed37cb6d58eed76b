from __future__ import annotations

import numpy as np
import pytest

from analysis.planning.deciding_tests import (
    BlockTests,
    FamilyRest,
    decided_by_holm,
    detection_shares,
)
from analysis.planning.many_studies import clustered_tests
from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.multiple_testing import holm


@pytest.mark.parametrize("density", [0.4, 1.0])
def test_many_studies_are_tested_as_each_of_them_would_be(density: float) -> None:
    chance = np.random.default_rng(5)
    shown = np.flatnonzero(chance.random(12 * 9) < density)
    people, items = shown // 9, shown % 9
    values = chance.integers(-2, 3, (40, len(shown))).astype(float)
    values[3] = 1.0
    values[4] = 0.0

    means, p_values = clustered_tests(values, people, items)

    for row, mean, p in zip(values, means, p_values, strict=True):
        alone = clustered_mean(row, people, items, null=0.0, limits=(-2.0, 2.0))
        assert mean == pytest.approx(alone.estimate)
        assert p == pytest.approx(alone.p_value, nan_ok=True)
    assert np.isnan(p_values[3:5]).all()
    assert not np.isnan(np.delete(p_values, [3, 4])).any()


def test_one_participant_and_no_answer_give_no_test() -> None:
    alone = np.zeros(3, np.intp)
    for count in (3, 0):
        _, p_values = clustered_tests(
            np.ones((2, count)) * np.arange(count), alone[:count], np.arange(count)
        )
        assert np.isnan(p_values).all()


def test_a_block_alone_is_corrected_within_itself() -> None:
    p_values = np.array([[0.01, 0.04, 0.2], [0.03, 0.02, 0.04]])

    decided = decided_by_holm(p_values, FamilyRest((p_values,), (0,)), 1)

    for row, own in zip(p_values, decided, strict=True):
        assert (own > 0).tolist() == [p < 0.05 for p in holm(row.tolist())]


def test_in_the_company_of_nothing_a_block_must_be_far_surer() -> None:
    nothing = np.full((10, 1), 0.9)
    company = FamilyRest((nothing,), (4,))

    decided = decided_by_holm(np.array([[0.02], [0.009]]), company, 1)

    assert decided.ravel().tolist() == [0.0, 1.0]


def test_in_the_company_of_what_decides_a_block_is_hardly_corrected() -> None:
    sure = np.full((10, 1), 1e-6)
    company = FamilyRest((sure,), (4,))

    assert decided_by_holm(np.array([[0.04]]), company, 1)[0, 0] == 1.0


def test_a_difference_counts_as_found_where_the_better_one_comes_out_ahead() -> None:
    tested = BlockTests(p_values=np.zeros((2, 2)), signs=np.array([[1.0, 1.0], [-1.0, 1.0]]))
    decided = np.ones((2, 2))

    assert detection_shares(tested, decided, (True, False), effect=0.4).tolist() == [1.0, 0.0]
    assert detection_shares(tested, decided, (True, False), effect=0.0).tolist() == [1.0, 1.0]


def test_tests_that_cannot_be_made_never_decide() -> None:
    p_values = np.array([[np.nan, 0.001]])

    decided = decided_by_holm(p_values, FamilyRest((p_values,), (0,)), 1)

    assert decided.tolist() == [[0.0, 1.0]]


def test_the_same_seed_draws_the_same_companies() -> None:
    chance = np.random.default_rng(2)
    pool = chance.random((50, 2)) / 10
    company = FamilyRest((pool,), (3,))

    first, again = (decided_by_holm(pool, company, 7) for _ in range(2))

    assert first == pytest.approx(again)
    assert set(np.unique(first)) - {0.0, 1.0}
