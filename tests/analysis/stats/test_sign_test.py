from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.stats.sign_test import sign_test


def test_six_above_and_one_below_worked_by_hand():
    found = sign_test(np.array([0.2, 0.1, 0.5, 0.3, 0.0, 0.4, 0.9, -0.1]))
    assert (found.above, found.below, found.zeros) == (6, 1, 1)
    assert found.p_value == pytest.approx(2 * (1 + 7) / 2**7)
    assert found.estimate == pytest.approx(6 / 7)
    assert found.low < 0.5 < found.high


def test_a_mean_that_is_zero_but_for_rounding_is_zero():
    assert sign_test(np.array([0.1 + 0.2 - 0.3, 1.0])).zeros == 1


@pytest.mark.parametrize(("values", "reason"), [([], "no values"), ([0.0], "all values are zero")])
def test_no_test_comes_with_its_reason(values, reason):
    found = sign_test(np.array(values))
    assert found.reason == reason
    assert math.isnan(found.p_value)
