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
def test_conclusions_match_known_differences(truth: float, estimate: float, sign: str) -> None:
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
