from __future__ import annotations

import math
import pickle
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


def test_results_are_picklable_with_read_only_settings() -> None:
    settings = {"a": "b"}
    result = MetricResult(
        name="m", value=1.0, unit="m", n=2, settings=settings, interval=(0.5, 2.0), remark="few"
    )
    settings["a"] = "c"
    sent = pickle.loads(pickle.dumps(result))  # noqa: S301
    assert sent == result
    assert sent.settings == {"a": "b"}
    with pytest.raises(TypeError):
        sent.settings["a"] = "c"
