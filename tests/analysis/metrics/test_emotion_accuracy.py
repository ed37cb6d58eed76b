import math
from collections.abc import Sequence

import pytest

from analysis.metrics.emotion_accuracy import emotion_accuracy, emotion_confusion
from analysis.metrics.scores import EmotionConfusion

LABELS = ("neutral", "anger", "fear")


def confusion(spoken: Sequence[str], named: Sequence[str]) -> EmotionConfusion:
    return emotion_confusion(spoken, named, LABELS, condition="ours", network="abc")


def test_rows_are_spoken_emotions_and_columns_predicted_ones() -> None:
    found = confusion(["anger", "anger", "neutral", "joy"], ["fear", "anger", "neutral", "fear"])
    assert found.spoken == ("neutral", "anger")
    assert found.named == LABELS
    assert found.counts == ((1, 0, 0), (0, 1, 1))


def test_emotions_have_equal_weight_whatever_their_number_of_clips() -> None:
    spoken = ["anger"] * 9 + ["fear"]
    found = emotion_accuracy(confusion(spoken, ["anger"] * 10))
    assert found.value == pytest.approx(0.5)
    assert found.n == 10
    assert found.settings["mean over"] == "anger (9), fear (1)"
    assert found.settings["chance"] == "1 / 3"


def test_without_a_known_emotion_there_is_no_score() -> None:
    found = emotion_accuracy(confusion(["joy"], ["fear"]))
    assert math.isnan(found.value)
    assert "no clip has speech of an emotion" in found.reason
