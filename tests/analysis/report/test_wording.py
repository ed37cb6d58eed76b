from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from analysis.report import wording
from analysis.stats.clustered_mean import clustered_mean


@pytest.mark.parametrize(
    ("formatted", "value", "text"),
    [
        (wording.share, 0.634, ".63"),
        (wording.share, 0.0, ".00"),
        (wording.share, 1.0, "1.00"),
        (wording.share, -0.021, "−.02"),
        (wording.share, -0.001, ".00"),
        (wording.share, 0.999, "1.00"),
        (wording.share, math.nan, "–"),
        (wording.p_value, 0.0004, f"<{wording.NO_BREAK}.001"),
        (wording.p_value, 0.0123, ".012"),
        (wording.p_value, 0.0996, ".10"),
        (wording.p_value, 0.34, ".34"),
        (wording.p_value, 0.999, "1"),
        (wording.p_value, math.nan, "–"),
        (wording.quantity, 1234.5, "1234"),
        (wording.quantity, 48.53, "48.5"),
        (wording.quantity, 0.01234, "0.0123"),
        (wording.quantity, -2.5, "−2.50"),
        (wording.quantity, 1e-15, "0"),
        (wording.number, -0.004, "0.00"),
        (wording.number, -0.006, "−0.01"),
        (wording.quantity, math.nan, "–"),
    ],
)
def test_shares_p_values_and_quantities_have_sensible_digits(
    formatted: Callable[[float], str], value: float, text: str
) -> None:
    assert formatted(value) == text


def test_an_estimate_has_an_interval_or_a_reason() -> None:
    values = np.array([1, 1, 0, 1.0])
    participants, segments = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])
    for estimate, words in (
        (clustered_mean(values, participants, segments), ".75 [.00, 1.00]"),
        (clustered_mean(values, np.zeros(4), segments), ".75 (no interval: one participant)"),
        (clustered_mean(np.zeros(0), np.zeros(0), np.zeros(0)), "– (no answers)"),
    ):
        assert wording.share_words(estimate).replace(wording.NO_BREAK, " ") == words


def test_ordinals_are_written_as_spoken() -> None:
    assert [wording.ordinal(place) for place in (1, 2, 3, 4, 11, 12, 13, 21, 22)] == [
        *("1st", "2nd", "3rd", "4th", "11th", "12th", "13th", "21st", "22nd")
    ]
