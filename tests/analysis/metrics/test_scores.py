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
def test_a_reason_belongs_to_a_missing_score_alone_and_an_interval_ends_above_its_start(
    fields: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        MetricResult(name="m", unit="", n=1, **fields)


def test_a_result_travels_to_another_process_as_it_is_with_settings_that_nobody_changes() -> None:
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
