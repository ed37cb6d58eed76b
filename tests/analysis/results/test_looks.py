from __future__ import annotations

import math
from dataclasses import replace

import pytest

from analysis.stats.multiple_testing import NOT_LOGGED, Look, equally_spaced, looks_before

LOOK = Look(
    day="2026-05-04",
    by="researcher 1",
    way="page",
    reason="a video broke",
    finished=10,
    planned=30,
    answers=100,
)
LATER = replace(LOOK, finished=20, answers=200)
NOW = replace(LOOK, finished=30, answers=300)


def test_looks_at_the_reported_answers_are_not_before_them() -> None:
    result = looks_before([LOOK, LATER, NOW, NOW], finished=30, answers=300)

    assert (result.count, result.looks, result.finished) == (2, (LOOK, LATER), (10, 20))
    assert result.false_positive_rate == pytest.approx(equally_spaced(3))
    assert result.reason == ""


def test_looks_in_a_row_that_are_alike_are_counted_together() -> None:
    other = replace(LOOK, reason="curious")

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
        ([replace(LOOK, finished=0)], 30, "no participant had finished"),
        ([LOOK], 0, "no participant had finished"),
    ],
)
def test_without_participants_or_looks_there_is_no_rate_but_a_reason(
    looks: list[Look], finished: int, reason: str
) -> None:
    result = looks_before(looks, finished=finished, answers=300)

    assert math.isnan(result.false_positive_rate)
    assert result.reason == reason
    assert math.isnan(NOT_LOGGED.false_positive_rate) and NOT_LOGGED.reason
