from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion.errors import InputError
from motion.hands import FINGERS, RELAXED_HANDS, added_to_mean_hands, read_mean_hands
from motion.rest_pose import REST_JOINTS
from motion.skeleton import JOINT_NAMES, forward_kinematics, joint_index
from tests.motion.random_clips import random_clip


def test_fingers_are_the_joints_below_the_wrists() -> None:
    assert all("_" in name and name[-1] in "123" for name in JOINT_NAMES[FINGERS])
    assert len(JOINT_NAMES[FINGERS]) == len(RELAXED_HANDS) == 30


def test_relaxed_hands_are_mirror_images_with_fingers_towards_the_palm() -> None:
    poses = np.zeros((1, 55, 3))
    poses[0, FINGERS] = RELAXED_HANDS
    positions, _ = forward_kinematics(poses, np.zeros((1, 3)), REST_JOINTS)
    for finger in ("index", "middle", "ring", "pinky"):
        left, right = (positions[0, joint_index(f"{s}_{finger}3")] for s in ("left", "right"))
        np.testing.assert_allclose(left, right * [-1, 1, 1], atol=1e-6)
        assert left[1] < REST_JOINTS[joint_index(f"left_{finger}3"), 1] - 0.01


def test_tips_of_a_relaxed_hand_are_nearer_to_each_other_than_in_an_open_one() -> None:
    poses = np.zeros((2, 55, 3))
    poses[1, FINGERS] = RELAXED_HANDS
    positions, _ = forward_kinematics(poses, np.zeros((2, 3)), REST_JOINTS)
    fingers = ("thumb", "index", "middle", "ring", "pinky")
    tips = positions[:, [joint_index(f"left_{finger}3") for finger in fingers]]
    apart = np.linalg.norm(np.diff(tips, axis=1), axis=2)
    assert (apart[1] < 0.97 * apart[0]).all()
    assert apart[1, 0] < 0.07


def test_only_fingers_change_and_resting_ones_become_the_mean_hands() -> None:
    clip = random_clip()
    mean = np.random.default_rng(0).normal(0, 0.5, (30, 3)).astype(np.float32)
    changed = added_to_mean_hands(clip, mean)
    np.testing.assert_array_equal(
        np.delete(changed.poses, np.r_[FINGERS], axis=1),
        np.delete(clip.poses, np.r_[FINGERS], axis=1),
    )
    np.testing.assert_allclose(
        changed.poses[:, FINGERS] - clip.poses[:, FINGERS],
        mean[None].repeat(len(clip), 0),
        atol=1e-6,
    )


def test_mean_hands_of_a_licensed_file_are_left_then_right(tmp_path: Path) -> None:
    left, right = np.arange(45.0), -np.arange(45.0)
    np.savez(tmp_path / "a.npz", hands_meanl=left, hands_meanr=right)
    hands = read_mean_hands(tmp_path / "a.npz")
    assert hands is not None
    np.testing.assert_array_equal(hands.reshape(2, 45), [left, right])


@pytest.mark.parametrize("arrays", [{}, {"hands_meanl": np.zeros(45), "hands_meanr": np.zeros(45)}])
def test_file_without_mean_hands_gives_none(tmp_path: Path, arrays: dict[str, np.ndarray]) -> None:
    np.savez(tmp_path / "a.npz", **arrays)
    assert read_mean_hands(tmp_path / "a.npz") is None


def test_garbled_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_text("hello")
    with pytest.raises(InputError, match=r"a\.npz: .* cannot be read"):
        read_mean_hands(tmp_path / "a.npz")
