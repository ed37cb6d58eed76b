from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from statsmodels.stats.multitest import multipletests

from analysis.stats.holm import holm


def test_holm_worked_by_hand():
    assert holm([0.01, 0.04, 0.03, 0.2]) == pytest.approx((0.04, 0.09, 0.09, 0.2))


def test_a_missing_test_stays_a_member_of_the_family():
    corrected = holm([0.01, math.nan, 0.02])
    assert corrected[0] == pytest.approx(0.03)
    assert math.isnan(corrected[1])
    assert corrected[2] == pytest.approx(0.04)
    assert holm([]) == ()


@settings(max_examples=15, deadline=None)  # statsmodels collects garbage at every call
@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_holm_never_lowers_a_p_value_and_keeps_their_order(p_values):
    corrected = np.array(holm(p_values))
    assert np.all(corrected >= np.array(p_values) - 1e-12)
    assert np.all(np.diff(corrected[np.argsort(p_values, kind="stable")]) >= -1e-12)


def test_the_correction_agrees_with_statsmodels() -> None:
    family = np.random.default_rng(1).beta(0.4, 2.0, 30).round(3)
    expected = multipletests(family, method="holm")[1]
    assert holm(family.tolist()) == pytest.approx(expected.tolist())
