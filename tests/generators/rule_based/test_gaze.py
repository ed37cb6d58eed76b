"""Eyes hold the viewer while the head moves, and blink as people do."""

from __future__ import annotations

import numpy as np
import pytest

from generators.rule_based.face_motion import blinks, gaze

TIMES = np.arange(0, 600, 1 / 30)


def test_eyes_make_up_for_the_head() -> None:
    head = np.zeros((len(TIMES), 3))
    head[:, 1] = 16.0
    weights = gaze(head, 0.0, TIMES, np.random.default_rng(0))
    np.testing.assert_allclose(weights["eyeLookInLeft"], 0.5)
    np.testing.assert_allclose(weights["eyeLookOutRight"], 0.5)
    assert not weights["eyeLookOutLeft"].any()


def test_a_lowered_head_looks_up() -> None:
    head = np.zeros((len(TIMES), 3))
    head[:, 0] = 10.0
    weights = gaze(head, 0.0, TIMES, np.random.default_rng(0))
    assert weights["eyeLookUp"].min() > 0
    assert not weights["eyeLookDown"].any()


def test_the_gaze_is_mostly_on_the_viewer() -> None:
    weights = gaze(np.zeros((len(TIMES), 3)), 8.0, TIMES, np.random.default_rng(0))
    on_viewer = (weights["eyeLookOutLeft"] < 0.01) & (weights["eyeLookInLeft"] < 0.01)
    assert 0.5 < on_viewer.mean() < 0.85


@pytest.mark.parametrize("per_minute", [12.0, 24.0, 36.0])
def test_blinks_come_as_often_as_asked(per_minute: float) -> None:
    shut = blinks(per_minute, TIMES, np.random.default_rng(0))
    closings = ((shut[1:] > 0.5) & (shut[:-1] <= 0.5)).sum()
    assert closings / 10 == pytest.approx(per_minute, rel=0.15)
    assert shut.min() >= 0 and shut.max() <= 1
