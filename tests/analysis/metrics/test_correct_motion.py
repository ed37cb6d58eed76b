from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from analysis.metrics.correct_motion import (
    AMUSE,
    BEAT,
    DIFFSHEG,
    CorrectSettings,
    percent_correct_motion,
    semantic_recall,
)

FloatArray = NDArray[np.float64]

SHAPE = (12, 4, 3)


def off(share: float, amount: float = 1.0) -> FloatArray:
    """Return a motion whose first joints are off by `amount` on one axis."""
    wrong = np.zeros(SHAPE)
    wrong[:, : int(share * SHAPE[1]), 0] = amount
    return wrong


@pytest.mark.parametrize("settings", [AMUSE, BEAT, DIFFSHEG], ids=lambda s: s.name)
def test_the_closed_forms_are_met_by_every_preset(
    closed_form: Mapping[str, Any], settings: CorrectSettings
) -> None:
    expected = closed_form["srgr"]
    far = 2 * settings.threshold
    recorded, weights = np.zeros(SHAPE), np.linspace(0.1, 1, SHAPE[0])
    for share, name in ((0, "perfect"), (1, "all_off"), (0.5, "half_joints_off")):
        motion = off(share, far)
        correct = percent_correct_motion(motion, recorded, settings=settings)
        recalled = semantic_recall(motion, recorded, weights, settings=settings)
        assert correct.value == pytest.approx(expected[name])
        assert recalled.value == pytest.approx(expected[name])


def test_weights_choose_the_frames_that_count(closed_form: Mapping[str, Any]) -> None:
    assert closed_form["srgr"]["weighted"].startswith("weights w_t=[1,0]")
    motion = np.zeros((2, 3, 3))
    motion[1] = 9
    found = [
        semantic_recall(motion, np.zeros((2, 3, 3)), np.array(weights), settings=AMUSE).value
        for weights in ([1.0, 0.0], [0.0, 1.0], [0.3, 0.1])
    ]
    assert found == pytest.approx([1.0, 0.0, 0.75])


def test_thresholds_are_strict_and_each_preset_measures_its_own_distance() -> None:
    recorded = np.zeros((1, 1, 3))
    diagonal = np.full((1, 1, 3), 1.4)
    assert percent_correct_motion(diagonal, recorded, settings=BEAT).value == 0
    euclidean = replace(BEAT, distance="Euclidean")
    assert percent_correct_motion(diagonal, recorded, settings=euclidean).value == 1
    at_threshold = np.array([[[0.5, 0.0, 0.0]]])
    assert percent_correct_motion(at_threshold, recorded, settings=DIFFSHEG).value == 0


def test_euler_angles_are_compared_the_short_way_round() -> None:
    one, other = np.full((2, 1, 3), 179.5), np.full((2, 1, 3), -179.5)
    assert percent_correct_motion(one, other, settings=BEAT).value == 1
    assert percent_correct_motion(one, other, settings=AMUSE).value == 0


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 100))
def test_recall_lies_between_zero_and_one_whatever_the_weights_scale(
    seed: int, scale: float
) -> None:
    chance = np.random.default_rng(seed)
    one, other = 0.1 * chance.standard_normal((2, *SHAPE))
    weights = chance.random(SHAPE[0])
    found = semantic_recall(one, other, weights, settings=AMUSE).value
    assert 0 <= found <= 1
    assert semantic_recall(one, other, scale * weights, settings=AMUSE).value == pytest.approx(
        found
    )
    even = semantic_recall(one, other, np.ones(SHAPE[0]), settings=AMUSE).value
    assert even == pytest.approx(percent_correct_motion(one, other, settings=AMUSE).value)


def test_no_weight_is_no_score_with_the_reason() -> None:
    found = semantic_recall(np.zeros(SHAPE), np.zeros(SHAPE), np.zeros(SHAPE[0]), settings=AMUSE)
    assert math.isnan(found.value)
    assert found.reason == "no frame has a semantic score above 0"


@pytest.mark.parametrize("weights", [np.ones(3), -np.ones(12), np.full(12, np.nan)])
def test_unusable_weights_are_refused(weights: FloatArray) -> None:
    with pytest.raises(ValueError, match="weight"):
        semantic_recall(np.zeros(SHAPE), np.zeros(SHAPE), weights, settings=AMUSE)


def test_a_clip_half_as_long_as_its_recording_does_not_pair() -> None:
    found = percent_correct_motion(np.zeros((50, 2, 3)), np.zeros((100, 2, 3)), settings=AMUSE)
    assert math.isnan(found.value)
    assert found.reason == "the clip has 50 frames and the recording 100"
    nearly = percent_correct_motion(np.zeros((98, 2, 3)), np.zeros((100, 2, 3)), settings=AMUSE)
    assert nearly.n == 98 * 2


def test_no_joint_is_no_score() -> None:
    none = np.zeros((5, 0, 3))
    assert "no joint" in percent_correct_motion(none, none, settings=DIFFSHEG).reason
    assert "no joint" in semantic_recall(none, none, np.ones(5), settings=DIFFSHEG).reason
