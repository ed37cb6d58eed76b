from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from motion.skeleton import (
    FINGERS,
    JOINT_COUNT,
    PARENTS,
    RELAXED_HANDS,
    REST_JOINTS,
    forward_kinematics,
    joint_index,
)


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
