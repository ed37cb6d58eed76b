from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.planning.deciding_tests import (
    BlockTests,
    clustered_tests,
    decided_by_holm,
    detection_shares,
)
from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.multiple_testing import holm


def test_many_studies_are_tested_as_each_of_them_would_be() -> None:
    chance = np.random.default_rng(5)
    shown = np.flatnonzero(chance.random(12 * 9) < 0.4)
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
    _, of_one_participant = clustered_tests(values, np.zeros_like(people), items)
    assert np.isnan(of_one_participant).all()


@pytest.mark.parametrize(
    ("block", "company", "decided"),
    [
        ([0.01, 0.04, 0.2], None, [1, 0, 0]),
        ([0.03, 0.02, 0.04], None, [0, 0, 0]),
        ([math.nan, 0.001], None, [0, 1]),
        # Among four blocks without an effect a test needs five times the evidence, among certain
        # ones hardly more.
        ([0.02], 0.9, [0]),
        ([0.009], 0.9, [1]),
        ([0.04], 1e-6, [1]),
    ],
)
def test_a_block_is_corrected_with_the_rest_of_its_family(
    block: list[float], company: float | None, decided: list[float]
) -> None:
    p_values = np.array([block])
    rest = [(np.full((10, 1), company or 0.0), 4 if company else 0)]

    if len(block) == 3:
        assert [p < 0.05 for p in holm(block)] == [bool(share) for share in decided]
    assert decided_by_holm(p_values, rest, 1).tolist() == [decided]


def test_a_difference_counts_as_found_only_in_the_right_direction() -> None:
    tested = BlockTests(p_values=np.zeros((2, 2)), signs=np.array([[1.0, 1.0], [-1.0, 1.0]]))
    decided = np.ones((2, 2))

    assert detection_shares(tested, decided, (True, False), effect=0.4).tolist() == [1.0, 0.0]
    assert detection_shares(tested, decided, (True, False), effect=0.0).tolist() == [1.0, 1.0]
