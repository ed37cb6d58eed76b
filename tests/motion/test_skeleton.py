from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from motion.skeleton import (
    FINGERS,
    JOINT_COUNT,
    JOINT_NAMES,
    PARENTS,
    RELAXED_HANDS,
    REST_JOINTS,
    forward_kinematics,
    joint_index,
)


def test_an_unposed_body_stands_where_its_rest_joints_are() -> None:
    positions, rotations = forward_kinematics(
        np.zeros((2, JOINT_COUNT, 3)), np.array([[0, 0, 0], [1, 2, 3]]), REST_JOINTS
    )
    np.testing.assert_allclose(positions[0], REST_JOINTS, atol=1e-12)
    np.testing.assert_allclose(positions[1], REST_JOINTS + np.array([1, 2, 3]), atol=1e-12)
    np.testing.assert_allclose(rotations, np.broadcast_to(np.eye(3), rotations.shape))


def test_turning_the_left_shoulder_down_lowers_the_left_hand_alone() -> None:
    poses = np.zeros((1, JOINT_COUNT, 3))
    poses[0, joint_index("left_shoulder"), 2] = -np.pi / 2
    positions, _ = forward_kinematics(poses, np.zeros((1, 3)), REST_JOINTS)
    moved = np.linalg.norm(positions[0] - REST_JOINTS, axis=1) > 1e-9
    shoulder, wrist = joint_index("left_shoulder"), joint_index("left_wrist")
    assert positions[0, wrist, 1] < positions[0, shoulder, 1] - 0.3
    assert {JOINT_NAMES[k] for k in np.flatnonzero(moved)} == {
        "left_elbow",
        "left_wrist",
        *(name for name in JOINT_NAMES if name.startswith("left_") and name[-1].isdigit()),
    }


@given(arrays(np.float64, (1, JOINT_COUNT, 3), elements=st.floats(-3, 3)))
def test_no_pose_changes_the_length_of_a_bone(poses: np.ndarray) -> None:
    positions, _ = forward_kinematics(poses, np.zeros((1, 3)), REST_JOINTS)
    parents = np.array(PARENTS[1:])
    lengths = np.linalg.norm(positions[0, 1:] - positions[0, parents], axis=1)
    rest = np.linalg.norm(REST_JOINTS[1:] - REST_JOINTS[parents], axis=1)
    np.testing.assert_allclose(lengths, rest, atol=1e-9)


def test_relaxed_hands_are_mirror_images_with_fingers_towards_the_palm() -> None:
    poses = np.zeros((1, 55, 3))
    poses[0, FINGERS] = RELAXED_HANDS
    positions, _ = forward_kinematics(poses, np.zeros((1, 3)), REST_JOINTS)
    for finger in ("index", "middle", "ring", "pinky"):
        left, right = (positions[0, joint_index(f"{s}_{finger}3")] for s in ("left", "right"))
        np.testing.assert_allclose(left, right * [-1, 1, 1], atol=1e-6)
        assert left[1] < REST_JOINTS[joint_index(f"left_{finger}3"), 1] - 0.01
