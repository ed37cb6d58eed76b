import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.metrics.correct_motion import AMUSE, BEAT, DIFFSHEG, CorrectSettings, correct_share

SHAPE = (12, 4, 3)


@pytest.mark.parametrize("settings", [AMUSE, BEAT, DIFFSHEG], ids=lambda s: s.name)
def test_every_preset_matches_its_closed_form(
    closed_form: Mapping[str, Any], settings: CorrectSettings
) -> None:
    expected = closed_form["srgr"]
    recorded, weights = np.zeros(SHAPE), np.linspace(0.1, 1, SHAPE[0])
    for wrong_joints, name in ((0, "perfect"), (4, "all_off"), (2, "half_joints_off")):
        motion = np.zeros(SHAPE)
        motion[:, :wrong_joints, 0] = 2 * settings.threshold
        correct = correct_share(motion, recorded, settings=settings)
        recalled = correct_share(motion, recorded, weights, settings=settings)
        assert correct.value == pytest.approx(expected[name])
        assert recalled.value == pytest.approx(expected[name])


def test_weights_choose_the_frames_that_count(closed_form: Mapping[str, Any]) -> None:
    assert closed_form["srgr"]["weighted"].startswith("weights w_t=[1,0]")
    motion = np.zeros((2, 3, 3))
    motion[1] = 9
    recalls = [
        correct_share(motion, np.zeros((2, 3, 3)), np.array(weights), settings=AMUSE).value
        for weights in ([1.0, 0.0], [0.0, 1.0], [0.3, 0.1])
    ]
    assert recalls == pytest.approx([1.0, 0.0, 0.75])


def test_thresholds_are_strict_and_each_preset_measures_its_own_distance() -> None:
    recorded = np.zeros((1, 1, 3))
    diagonal = np.full((1, 1, 3), 1.4)
    assert correct_share(diagonal, recorded, settings=BEAT).value == 0
    euclidean = replace(BEAT, distance="Euclidean")
    assert correct_share(diagonal, recorded, settings=euclidean).value == 1
    at_threshold = np.array([[[0.5, 0.0, 0.0]]])
    assert correct_share(at_threshold, recorded, settings=DIFFSHEG).value == 0


def test_euler_angles_are_compared_modulo_a_full_turn() -> None:
    one, other = np.full((2, 1, 3), 179.5), np.full((2, 1, 3), -179.5)
    assert correct_share(one, other, settings=BEAT).value == 1
    assert correct_share(one, other, settings=AMUSE).value == 0


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 100))
def test_recall_lies_between_zero_and_one_whatever_the_weights_scale(
    seed: int, scale: float
) -> None:
    chance = np.random.default_rng(seed)
    one, other = 0.1 * chance.standard_normal((2, *SHAPE))
    weights = chance.random(SHAPE[0])
    recall = correct_share(one, other, weights, settings=AMUSE).value
    scaled = correct_share(one, other, scale * weights, settings=AMUSE).value
    assert 0 <= recall <= 1
    assert scaled == pytest.approx(recall)
    even = correct_share(one, other, np.ones(SHAPE[0]), settings=AMUSE).value
    assert even == pytest.approx(correct_share(one, other, settings=AMUSE).value)


def test_clips_that_cannot_be_compared_have_a_reason_instead_of_a_score() -> None:
    whole, half, no_joint = np.zeros((100, 2, 3)), np.zeros((50, 2, 3)), np.zeros((5, 0, 3))
    for result, reason in (
        (correct_share(whole, whole, np.zeros(100), settings=AMUSE), "no frame has a semantic"),
        (correct_share(half, whole, settings=AMUSE), "50 frames and the recording 100"),
        (correct_share(no_joint, no_joint, settings=DIFFSHEG), "no joint moves"),
    ):
        assert math.isnan(result.value)
        assert reason in result.reason
    assert correct_share(whole[:98], whole, settings=AMUSE).n == 98 * 2
