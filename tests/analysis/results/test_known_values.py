from __future__ import annotations

import math

import pytest

from analysis.results.known_values import KnownDifference
from analysis.stats.clustered_mean import Estimate


def difference(truth: float, estimate: float, half: float) -> KnownDifference:
    found = Estimate(estimate=estimate, low=estimate - half, high=estimate + half, participants=25)
    return KnownDifference(
        part="",
        question="fit",
        measure="win_share",
        first="ours",
        second="theirs",
        truth=truth,
        found=found,
        decided=not found.covers(0.0),
    )


@pytest.mark.parametrize(
    ("truth", "estimate", "half", "sign"),
    [
        (0.1, 0.2, 0.1, "right"),
        (-0.1, -0.2, 0.1, "right"),
        (-0.1, 0.2, 0.1, "wrong"),
        (0.1, 0.05, 0.1, "undecided"),
        (0.0, 0.05, 0.1, "equal"),
        (0.0, 0.3, 0.1, "wrong"),
    ],
)
def test_the_better_one_is_found_or_not(
    truth: float, estimate: float, half: float, sign: str
) -> None:
    assert difference(truth, estimate, half).sign == sign


def test_an_interval_that_is_not_there_holds_nothing() -> None:
    found = Estimate(estimate=0.5, reason="one participant")
    assert not found.has_interval
    assert not found.covers(0.5)
    assert math.isnan(KnownDifference.half_width.fget(difference(0, 0, math.nan)))  # type: ignore[attr-defined]


def test_the_other_sides_share_is_the_mirror_image() -> None:
    turned = Estimate(estimate=0.7, low=0.6, high=0.75).mirrored()
    assert (turned.estimate, turned.low, turned.high) == pytest.approx((0.3, 0.25, 0.4))
