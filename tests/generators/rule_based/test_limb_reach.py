"""Inverse kinematics: the hand gets where it should, elbows bend the way elbows do."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from generators.rule_based.limb_reach import Limb, reach

ARM = Limb(
    upper=np.array([0.27, 0.0, 0.0]),
    lower=np.array([0.25, 0.0, 0.0]),
    folds_toward=np.array([0.0, 0.0, 1.0]),
    comfort=0.93,
)
POLE = np.array([[0.45, -0.75, -0.6]])

numbers = st.floats(-1, 1)


def end_of(limb: Limb, upper: np.ndarray, lower: np.ndarray) -> np.ndarray:
    return upper @ limb.upper + lower @ limb.lower


@given(numbers, numbers, numbers, st.floats(0.36, 0.92))
def test_the_hand_is_at_its_target(x: float, y: float, z: float, share: float) -> None:
    direction = np.array([[x, y, z]])
    assume(np.linalg.norm(direction) > 0.1)
    direction /= np.linalg.norm(direction)
    assume(abs((direction * POLE / np.linalg.norm(POLE)).sum()) < 0.99)
    target = direction * share * ARM.length
    upper, lower = reach(ARM, np.zeros((1, 3)), target, POLE)
    np.testing.assert_allclose(end_of(ARM, upper, lower), target, atol=1e-9)
    for turn in (upper[0], lower[0]):
        np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(turn) == pytest.approx(1)


def test_the_elbow_bends_about_its_hinge_alone() -> None:
    upper, lower = reach(ARM, np.zeros((1, 3)), np.array([[0.1, -0.2, 0.3]]), POLE)
    bend = np.swapaxes(upper, 1, 2) @ lower
    np.testing.assert_allclose(bend[0] @ [0, 1, 0], [0, 1, 0], atol=1e-9)
    assert bend[0, 2, 0] > 0, "the forearm folds forwards"


def test_the_elbow_points_to_the_pole() -> None:
    target = np.array([[0.0, -0.1, 0.4]])
    for pole in ([[0.0, -1.0, 0.0]], [[1.0, 0.0, 0.0]]):
        upper, _ = reach(ARM, np.zeros((1, 3)), target, np.array(pole))
        assert (upper @ ARM.upper)[0] @ pole[0] > 0.1


def test_a_target_out_of_reach_is_approached_without_a_snap() -> None:
    shares = np.linspace(0.85, 1.3, 200)
    targets = np.outer(shares * ARM.length, [0.0, 0.0, 1.0])
    root, pole = np.zeros_like(targets), np.tile(POLE, (200, 1))
    upper, lower = reach(ARM, root, targets, pole)
    spans = end_of(ARM, upper, lower)[:, 2] / ARM.length
    assert (np.diff(spans) >= -1e-9).all()
    assert spans.max() < 1
    assert np.diff(spans, 2).min() > -0.0005
