from __future__ import annotations

import math
import pickle

import pytest

from analysis.metrics.result import MetricResult


@pytest.mark.parametrize(("value", "reason"), [(math.nan, ""), (0.5, "no beats")])
def test_a_reason_belongs_to_a_missing_score_and_to_nothing_else(value: float, reason: str) -> None:
    with pytest.raises(ValueError, match="reason"):
        MetricResult(name="m", value=value, unit="", n=1, reason=reason)


def test_settings_cannot_be_changed_afterwards() -> None:
    given = {"joints": "wrists"}
    result = MetricResult(name="m", value=1.0, unit="", n=1, settings=given)
    given["joints"] = "feet"
    assert result.settings["joints"] == "wrists"


def test_an_interval_ends_above_its_start() -> None:
    with pytest.raises(ValueError, match="interval"):
        MetricResult(name="m", value=1.0, unit="", n=1, interval=(2.0, 1.0))


def test_a_result_travels_to_another_process_as_it_is() -> None:
    result = MetricResult(
        name="m", value=1.0, unit="m", n=2, settings={"a": "b"}, interval=(0.5, 2.0), remark="few"
    )
    found = pickle.loads(pickle.dumps(result))  # noqa: S301
    assert found == result
    with pytest.raises(TypeError):
        found.settings["a"] = "c"


def test_results_of_equal_settings_share_them() -> None:
    one, other = (
        MetricResult(name="m", value=1.0, unit="", n=1, settings={"joints": "wrists"})
        for _ in range(2)
    )
    assert one.settings is other.settings
