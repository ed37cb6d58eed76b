from __future__ import annotations

import pytest

from analysis.results.known_values import KnownDifference
from analysis.stats.clustered_mean import Estimate


@pytest.mark.parametrize(
    ("truth", "estimate", "sign"),
    [
        (0.1, 0.2, "right"),
        (-0.1, -0.2, "right"),
        (-0.1, 0.2, "wrong"),
        (0.1, 0.05, "undecided"),
        (0.0, 0.05, "equal"),
        (0.0, 0.3, "wrong"),
    ],
)
def test_the_better_one_is_found_or_not(truth: float, estimate: float, sign: str) -> None:
    result = Estimate(estimate=estimate, low=estimate - 0.1, high=estimate + 0.1)
    difference = KnownDifference(
        part="",
        question="fit",
        measure="win_share",
        first="ours",
        second="theirs",
        truth=truth,
        found=result,
        decided=not result.covers(0.0),
    )
    assert difference.sign == sign
    assert difference.half_width == pytest.approx(0.1)


def test_a_missing_interval_covers_nothing() -> None:
    result = Estimate(estimate=0.5, reason="one participant")
    assert not result.has_interval
    assert not result.covers(0.5)


def test_the_other_sides_share_is_the_mirror_image() -> None:
    mirrored = Estimate(estimate=0.7, low=0.6, high=0.75).mirrored()
    assert (mirrored.estimate, mirrored.low, mirrored.high) == pytest.approx((0.3, 0.25, 0.4))
