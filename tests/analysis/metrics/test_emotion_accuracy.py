from __future__ import annotations

import math
import pickle

import pytest

from analysis.metrics.emotion_accuracy import emotion_accuracy, emotion_confusion
from analysis.metrics.result import MetricResult

LABELS = ("neutral", "anger", "fear")


def confusion(spoken, named):
    return emotion_confusion(spoken, named, LABELS, condition="ours", network="abc")


def test_rows_are_spoken_emotions_and_columns_named_ones():
    found = confusion(["anger", "anger", "neutral", "joy"], ["fear", "anger", "neutral", "fear"])
    assert found.spoken == ("neutral", "anger")
    assert found.named == LABELS
    assert found.counts == ((1, 0, 0), (0, 1, 1))


def test_emotions_count_alike_however_many_clips_they_have():
    spoken = ["anger"] * 9 + ["fear"]
    found = emotion_accuracy(confusion(spoken, ["anger"] * 10))
    assert found.value == pytest.approx(0.5)
    assert found.n == 10
    assert found.settings["mean over"] == "anger (9), fear (1)"
    assert found.settings["chance"] == "1 / 3"


def test_the_interval_of_one_emotion_is_wilsons():
    found = emotion_accuracy(confusion(["fear"] * 10, ["fear"] * 7 + ["anger"] * 3))
    # R: binom::binom.confint(7, 10, methods = "wilson")
    assert found.interval == pytest.approx((0.3967781, 0.8922087), abs=1e-6)


def test_all_right_is_not_certain():
    found = emotion_accuracy(confusion(["fear"] * 8, ["fear"] * 8))
    assert found.value == 1
    assert found.interval[0] < 0.8
    assert found.interval[1] == 1


def test_no_emotion_that_the_network_knows_is_no_score():
    found = emotion_accuracy(confusion(["joy"], ["fear"]))
    assert math.isnan(found.value)
    assert "no clip has speech of an emotion" in found.reason


@pytest.mark.parametrize(("value", "reason"), [(math.nan, ""), (0.5, "no beats")])
def test_a_reason_belongs_to_a_missing_score_and_to_nothing_else(value, reason):
    with pytest.raises(ValueError, match="reason"):
        MetricResult(name="m", value=value, unit="", n=1, reason=reason)


def test_settings_cannot_be_changed_afterwards():
    given = {"joints": "wrists"}
    result = MetricResult(name="m", value=1.0, unit="", n=1, settings=given)
    given["joints"] = "feet"
    assert result.settings["joints"] == "wrists"


def test_an_interval_ends_above_its_start():
    with pytest.raises(ValueError, match="interval"):
        MetricResult(name="m", value=1.0, unit="", n=1, interval=(2.0, 1.0))


def test_a_result_travels_to_another_process_as_it_is():
    result = MetricResult(
        name="m", value=1.0, unit="m", n=2, settings={"a": "b"}, interval=(0.5, 2.0), remark="few"
    )
    found = pickle.loads(pickle.dumps(result))  # noqa: S301
    assert found == result
    with pytest.raises(TypeError):
        found.settings["a"] = "c"


def test_results_of_equal_settings_share_them():
    one, other = (
        MetricResult(name="m", value=1.0, unit="", n=1, settings={"joints": "wrists"})
        for _ in range(2)
    )
    assert one.settings is other.settings
