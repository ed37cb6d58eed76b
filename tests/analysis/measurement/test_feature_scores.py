import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from analysis.evaluators import feature_networks as names
from analysis.evaluators.feature_networks import ClipFeatures, Network
from analysis.measurement.feature_scores import feature_scores
from tests.analysis.measurement.reading import score_of

LABELS = ("neutral", "anger", "fear")


def network(name: str = names.GESTURE, labels: tuple[str, ...] = ()) -> Network:
    return Network(
        source=Path("n"), sha256="ab" * 32, name=name, settings={"a": "b"}, labels=labels
    )


def clips(
    count: int,
    *,
    shift: float = 0.0,
    dimensions: int = 3,
    seed: int = 0,
    windows: int = 2,
    named: Sequence[int] | None = None,
) -> dict[str, ClipFeatures]:
    chance = np.random.default_rng(seed)
    found = {}
    for number in range(count):
        emotions = np.zeros((windows, 0), np.float32)
        if named is not None:
            emotions = np.tile(np.eye(3, dtype=np.float32)[named[number]], (windows, 1))
        features = chance.normal(shift, 1, (windows, dimensions)).astype(np.float32)
        found[f"s{number:02d}"] = ClipFeatures(features=features, emotions=emotions)
    return found


def test_clips_further_from_the_recordings_score_worse_in_every_distance() -> None:
    recorded = clips(30)
    conditions = {"near": clips(30, seed=1), "far": clips(30, seed=2, shift=2.0)}
    found = feature_scores(network(), conditions, recorded)
    for name in (names.FGD, "FGD∞ (gesture autoencoder)", names.kernel_of(names.GESTURE)):
        near, far = (score_of(found, condition, name) for condition in ("near", "far"))
        assert near.value < far.value
        assert near.better == "lower"
        assert near.settings["a"] == "b"
    interval = score_of(found, "far", names.FGD).interval
    assert interval is not None
    assert interval[0] > score_of(found, "near", names.FGD).value


def test_conditions_are_compared_over_equally_many_windows_without_those_of_few_clips() -> None:
    conditions = {"all": clips(30, seed=1), "fewer": clips(20, seed=2), "catch": clips(3, seed=2)}
    found = feature_scores(network(), conditions, clips(40))
    for condition in ("all", "fewer"):
        settings = score_of(found, condition, names.FGD).settings
        assert settings["samples"] == "40 windows of recorded motion and of every condition"
    few = score_of(found, "catch", names.FGD)
    assert math.isnan(few.value)
    assert "6 windows are fewer than half of what others have" in few.reason
    assert not math.isnan(score_of(found, "catch", names.kernel_of(names.GESTURE)).value)


def test_recorded_motion_has_a_variance_but_no_distance() -> None:
    variance = "variance of features (gesture autoencoder)"
    recorded = clips(10)
    of_itself = feature_scores(
        network(), {"recorded": recorded}, recorded, recordings=frozenset({"recorded"})
    )
    assert [score.name for score in of_itself.conditions] == [variance]
    alone = feature_scores(network(), {"ours": recorded}, {})
    reason = score_of(alone, "ours", names.FGD).reason
    assert reason == "there is no recorded motion to compare with"
    assert score_of(alone, "ours", variance).value > 0


def test_predicted_emotions_are_counted_and_have_equal_weight_if_the_network_knows_them() -> None:
    ours = clips(4, named=[1, 2, 2, 0])
    found = feature_scores(
        network(names.EMOTION, LABELS),
        {"ours": ours, "joyful": {"s03": ours["s03"]}},
        clips(4, named=[0, 0, 0, 0]),
        emotions={"s00": "anger", "s01": "anger", "s02": "fear", "s03": "joy"},
    )
    accuracy, unknown = (
        score_of(found, condition, names.EMOTION_ACCURACY) for condition in ("ours", "joyful")
    )
    assert accuracy.value == pytest.approx(0.75)
    assert accuracy.settings["mean over"] == "anger (2), fear (1)"
    assert accuracy.settings["chance"] == "1 / 3"
    assert [score.result.value for score in found.clips] == [1, 0, 1]
    assert found.clips[1].result.remark == "spoken: anger, named: fear"
    assert (found.confusions[0].spoken, found.confusions[0].named) == (("anger", "fear"), LABELS)
    assert found.confusions[0].counts == ((0, 1, 1), (0, 0, 1))
    assert "no clip has speech of an emotion" in unknown.reason
