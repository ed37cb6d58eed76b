from __future__ import annotations

import math

import numpy as np
import pytest
from statsmodels.stats.multitest import multipletests

from analysis.stats.multiple_testing import equally_spaced, false_positive_rate, holm


def test_a_missing_test_stays_a_member_of_the_family() -> None:
    corrected = holm([0.01, math.nan, 0.02])
    assert corrected[0] == pytest.approx(0.03)
    assert math.isnan(corrected[1])
    assert corrected[2] == pytest.approx(0.04)
    assert holm([]) == ()


def test_the_correction_agrees_with_statsmodels() -> None:
    family = np.random.default_rng(1).beta(0.4, 2.0, 30).round(3)
    expected = multipletests(family, method="holm")[1]
    assert holm(family.tolist()) == pytest.approx(expected.tolist())


PUBLISHED = {1: 0.050, 2: 0.083, 3: 0.107, 4: 0.126, 5: 0.142, 10: 0.193, 20: 0.248, 50: 0.320}
"""Armitage, McPherson & Rowe (1969), table 2: tests at .05 with known variance."""


@pytest.mark.parametrize(("looks", "rate"), PUBLISHED.items())
def test_equally_spaced_looks_have_the_published_rates(looks: int, rate: float) -> None:
    assert equally_spaced(looks) == pytest.approx(rate, abs=6e-4)


def test_unequal_looks_err_as_often_as_simulated_studies_do() -> None:
    looks = np.array([5, 8, 20, 25])
    steps = np.diff(looks, prepend=0) ** 0.5
    walks = np.random.default_rng(1).normal(size=(400_000, 4)) * steps
    result = (np.abs(walks.cumsum(axis=1)) > 1.959964 * looks**0.5).any(axis=1).mean()

    assert false_positive_rate(looks.tolist()) == pytest.approx(result, abs=0.002)


def test_a_look_at_the_same_participants_again_costs_nothing() -> None:
    assert false_positive_rate([25, 12, 12, 25]) == false_positive_rate([12, 25])
    assert false_positive_rate([25]) == pytest.approx(0.05, abs=1e-9)
    assert false_positive_rate([]) == 0


def test_looks_after_every_single_one_of_many_participants_are_followed() -> None:
    close, apart = false_positive_rate([999, 1000]), false_positive_rate([500, 1000])

    assert 0.05 < close < 0.06 < apart
    assert equally_spaced(100) == pytest.approx(0.374, abs=1e-3)
