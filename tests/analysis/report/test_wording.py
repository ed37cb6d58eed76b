from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.report import wording
from analysis.report.wording import share_words
from analysis.stats.clustered_mean import clustered_mean


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.634, ".63"),
        (0.0, ".00"),
        (1.0, "1.00"),
        (-0.021, "−.02"),
        (-0.001, ".00"),
        (0.999, "1.00"),
        (math.nan, "–"),
    ],
)
def test_shares_have_two_digits_and_no_leading_zero(value: float, text: str) -> None:
    assert wording.share(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0004, f"<{wording.NO_BREAK}.001"),
        (0.0123, ".012"),
        (0.0996, ".10"),
        (0.34, ".34"),
        (0.999, "1"),
        (math.nan, "–"),
    ],
)
def test_p_values_have_sensible_digits(value: float, text: str) -> None:
    assert wording.p_value(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1234.5, "1234"),
        (48.53, "48.5"),
        (0.01234, "0.0123"),
        (-2.5, "−2.50"),
        (1e-15, "0"),
        (math.nan, "–"),
    ],
)
def test_quantities_have_three_significant_digits(value: float, text: str) -> None:
    assert wording.quantity(value) == text


def test_a_heading_keeps_capitals_of_its_own() -> None:
    assert wording.heading("fit_to_GT") == "Fit to GT"


def test_a_number_that_rounds_to_zero_has_no_sign() -> None:
    assert wording.fixed(-0.0004, 3) == "0.000"
    assert wording.fixed(-0.0006, 3) == "−0.001"


def test_decimals_follow_the_smallest_value_that_is_none() -> None:
    assert wording.decimals([13.9, 265.0], digits=2) == 0
    assert wording.decimals([0.059, 0.0, math.nan, 0.037], digits=2) == 3
    assert wording.decimals([], digits=2) == 0


def test_an_estimate_stands_with_its_interval_or_with_the_reason() -> None:
    values = np.array([1, 1, 0, 1.0])
    people, items = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])
    found = clustered_mean(values, people, items)
    assert share_words(found).replace(wording.NO_BREAK, " ") == ".75 [.00, 1.00]"
    alone = clustered_mean(values, np.zeros(4), items)
    assert share_words(alone) == ".75 (no interval: one participant)"
    nobody = clustered_mean(np.zeros(0), np.zeros(0), np.zeros(0))
    assert share_words(nobody) == "– (no answers)"


def test_counts_read_as_words() -> None:
    assert wording.count(1, "segment") == "1 segment"
    assert wording.count(2016, "answer") == "2,016 answers"
