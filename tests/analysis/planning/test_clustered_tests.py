from __future__ import annotations

import numpy as np
import pytest

from analysis.planning.clustered_tests import clustered_tests
from analysis.stats.clustered_mean import clustered_mean


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
