from __future__ import annotations

import math
from typing import Any

import pytest

from analysis.metrics.scores import MetricResult


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"value": math.nan}, "reason"),
        ({"value": 0.5, "reason": "no beats"}, "reason"),
        ({"value": 1.0, "interval": (2.0, 1.0)}, "interval"),
    ],
)
def test_only_missing_scores_have_reasons_and_intervals_are_ordered(
    fields: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        MetricResult(name="m", unit="", n=1, **fields)
