"""SHOW's values to a clip and back."""

from __future__ import annotations

import numpy as np
import pytest

from generators.diffsheg.config import SHOW
from motion.hands import FINGERS, RELAXED_HANDS
from motion.skeleton import JOINT_NAMES, joint_index
from training.spaces.show import TOLD_JOINTS, show_clip, show_values

RNG = np.random.default_rng(8)


def test_body_hands_jaw_and_expressions_are_as_wide_as_the_network() -> None:
    assert 3 * len(TOLD_JOINTS) == SHOW.gesture_width
    assert len(set(TOLD_JOINTS)) == 43
    assert show_values(show_clip(np.zeros((2, 232)), 30)).shape == (2, SHOW.motion_width)


def test_values_come_back_with_the_relaxed_hands_added() -> None:
    values = RNG.normal(0, 0.2, (5, 232))
    expected = values.copy()
    expected[:, 39:129] += RELAXED_HANDS.reshape(-1)
    np.testing.assert_allclose(show_values(show_clip(values, 30)), expected, atol=1e-6)


@pytest.mark.parametrize(
    ("column", "joint"),
    [(0, "spine1"), (9, "neck"), (18, "head"), (27, "left_elbow"), (36, "right_wrist"),
     (129, "jaw")],
)  # fmt: skip
def test_each_value_turns_its_joint_and_no_other(column: int, joint: str) -> None:
    values = np.zeros((1, 232))
    values[0, column] = 0.5
    clip, still = show_clip(values, 30), show_clip(np.zeros((1, 232)), 30)
    changed = np.flatnonzero((clip.poses != still.poses).any(axis=(0, 2)))
    assert [JOINT_NAMES[index] for index in changed] == [joint]


def test_a_still_clip_stands_upright_with_relaxed_hands_and_a_neutral_face() -> None:
    clip = show_clip(np.zeros((1, 232)), 30)
    np.testing.assert_allclose(clip.poses[0, FINGERS], RELAXED_HANDS, atol=1e-6)
    others = [i for i in range(len(JOINT_NAMES)) if not FINGERS.start <= i < FINGERS.stop]
    assert (clip.poses[0, others] == 0).all()
    assert clip.expressions is not None
    assert not clip.expressions.any()
    assert clip.poses[0, joint_index("jaw")].tolist() == [0, 0, 0]
