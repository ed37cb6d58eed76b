import math

import numpy as np
import pytest
from statsmodels.stats.multitest import multipletests

from analysis.stats.multiple_testing import (
    NOT_LOGGED,
    Look,
    false_positive_rate,
    holm,
    looks_before,
)
from tests.analysis.looks import looked


def test_a_missing_test_stays_a_member_of_the_family() -> None:
    corrected = holm([0.01, math.nan, 0.02])
    assert corrected == pytest.approx([0.03, math.nan, 0.04], nan_ok=True)
    assert holm([]) == ()


def test_the_correction_agrees_with_statsmodels() -> None:
    family = np.random.default_rng(1).beta(0.4, 2.0, 30).round(3)
    expected = multipletests(family, method="holm")[1]
    assert holm(family.tolist()) == pytest.approx(expected.tolist())


PUBLISHED = {1: 0.050, 2: 0.083, 3: 0.107, 5: 0.142, 10: 0.193, 50: 0.320, 100: 0.374}
"""Armitage, McPherson & Rowe (1969), table 2: tests at .05 with known variance."""


@pytest.mark.parametrize(("looks", "rate"), PUBLISHED.items())
def test_equally_spaced_looks_have_the_published_error_rates(looks: int, rate: float) -> None:
    assert false_positive_rate(range(1, looks + 1)) == pytest.approx(rate, abs=6e-4)


def test_error_rates_of_unequal_looks_match_simulation() -> None:
    looks = np.array([5, 8, 20, 25])
    steps = np.diff(looks, prepend=0) ** 0.5
    walks = np.random.default_rng(1).normal(size=(400_000, 4)) * steps
    result = (np.abs(walks.cumsum(axis=1)) > 1.959964 * looks**0.5).any(axis=1).mean()

    assert false_positive_rate(looks.tolist()) == pytest.approx(result, abs=0.002)


def test_a_look_at_the_same_participants_again_costs_nothing() -> None:
    assert false_positive_rate([25, 12, 12, 25]) == false_positive_rate([12, 25])
    assert 0.05 < false_positive_rate([999, 1000]) < 0.06
    assert false_positive_rate([]) == 0


LOOK, LATER, NOW = map(looked, (10, 20, 30))


def test_looks_at_the_reported_answers_do_not_count_as_earlier() -> None:
    result = looks_before([LOOK, LATER, NOW, NOW], finished=30, answers=300)

    assert (result.count, result.looks, result.finished) == (2, (LOOK, LATER), (10, 20))
    assert result.false_positive_rate == pytest.approx(false_positive_rate(range(1, 4)))
    assert result.reason == ""


def test_consecutive_identical_looks_are_counted_together() -> None:
    other = looked(10, "curious")

    result = looks_before([LOOK, LOOK, other, LOOK], finished=30, answers=300)

    assert [(look.reason, look.times) for look in result.looks] == [
        ("a video broke", 2),
        ("curious", 1),
        ("a video broke", 1),
    ]
    assert result.count == 4
    assert result.false_positive_rate == pytest.approx(
        looks_before([LOOK], finished=30, answers=300).false_positive_rate
    )


@pytest.mark.parametrize(
    ("looks", "finished", "reason"),
    [
        ([], 30, "no look is logged"),
        ([looked(0)], 30, "no participant had finished"),
        ([LOOK], 0, "no participant had finished"),
    ],
)
def test_without_participants_or_looks_there_is_a_reason_instead_of_a_rate(
    looks: list[Look], finished: int, reason: str
) -> None:
    result = looks_before(looks, finished=finished, answers=300)

    assert math.isnan(result.false_positive_rate)
    assert result.reason == reason
    assert math.isnan(NOT_LOGGED.false_positive_rate) and NOT_LOGGED.reason
