from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from motion.rest_pose import REST_JOINTS
from motion.skeleton import JOINT_COUNT, JOINT_NAMES, PARENTS, forward_kinematics, joint_index


def test_every_joint_but_the_pelvis_comes_after_its_parent() -> None:
    assert PARENTS[0] == -1
    assert all(0 <= parent < joint for joint, parent in enumerate(PARENTS) if joint)


def test_hands_hang_on_their_own_wrists() -> None:
    for joint, name in enumerate(JOINT_NAMES):
        if name[-1] == "1" and "spine" not in name:
            assert JOINT_NAMES[PARENTS[joint]] == name.split("_")[0] + "_wrist"


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
