from __future__ import annotations

import math

import pytest

from benchmarks.validity.realised import Realised, Share, Tally


def realised(significant: int, covered: int, studies: int = 1000) -> Realised:
    without = Tally(studies=studies, tested=studies, significant=significant)
    with_effect = Tally(studies=studies, tested=studies, bounded=studies, covered=covered)
    return Realised.of(without, with_effect)


@pytest.mark.parametrize(
    ("significant", "covered", "verdict"),
    [
        (50, 950, "headline"),
        (29, 950, "conservative"),
        (300, 950, "not a headline"),
        (50, 700, "not a headline"),
        (66, 950, "not a headline (within error)"),
        (50, 929, "not a headline (within error)"),
        (300, 929, "not a headline"),
        (65, 930, "headline"),
    ],
)
def test_the_verdict_keeps_to_its_limits(significant: int, covered: int, verdict: str) -> None:
    assert realised(significant, covered).verdict == verdict


def test_a_number_without_intervals_is_judged_by_its_test() -> None:
    without = Tally(studies=100, tested=100, significant=5)

    found = Realised.of(without, without)

    assert math.isnan(found.coverage.value)
    assert found.verdict == "headline"


def test_studies_without_a_number_are_counted_and_left_out() -> None:
    some = Tally(studies=10, tested=8, significant=4, silent=2)

    found = Realised.of(some, some)

    assert found.silent == pytest.approx(0.2)
    assert found.power.value == pytest.approx(0.5)


@pytest.mark.parametrize("part", [0, 10])
def test_a_share_of_none_or_all_is_not_without_error(part: int) -> None:
    assert Share.of(part, 10).error > 0.05
