import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion.body.skinning import TwistJoints, skinning_matrices, twist_angles
from motion.skeleton import JOINT_COUNT, REST_JOINTS, joint_index

ELBOW, WRIST = joint_index("left_elbow"), joint_index("left_wrist")
ALONG = np.array([1.0, 0.0, 0.0])  # the left forearm at rest


def _on_forearm(*shares: tuple[float, float]) -> TwistJoints:
    bones = np.tile([ELBOW, WRIST], (len(shares), 1))
    return TwistJoints(bones=bones, shares=np.array(shares))


@given(
    swing=st.floats(-3, 3),
    twist=st.floats(-3, 3),
    around=st.floats(0, 2 * np.pi),
    seed=st.integers(0, 99),
)
def test_twist_is_the_rotation_without_the_swing(
    swing: float, twist: float, around: float, seed: int
) -> None:
    frame = Rotation.random(rng=seed)
    axis = frame.apply([1, 0, 0])
    across = frame.apply([0, np.cos(around), np.sin(around)])
    turn = Rotation.from_rotvec(swing * across) * Rotation.from_rotvec(twist * axis)
    assert twist_angles(turn.as_quat(), axis) == pytest.approx(twist, abs=1e-6)


@given(elbow=st.floats(-1.5, 1.5), wrist=st.floats(-1.5, 1.5), share=st.floats(0, 1))
def test_skin_of_the_forearm_turns_from_the_upper_arm_to_the_hand(
    elbow: float, wrist: float, share: float
) -> None:
    poses, joints = np.zeros((1, JOINT_COUNT, 3)), _on_forearm((share - 1, share))
    poses[0, ELBOW], poses[0, WRIST] = elbow * ALONG, wrist * ALONG
    matrix = skinning_matrices(poses, np.zeros((1, 3)), REST_JOINTS, joints)
    turn = Rotation.from_matrix(matrix[0, -1, :, :3]).as_rotvec()
    np.testing.assert_allclose(turn, share * (elbow + wrist) * ALONG, atol=1e-6)


def test_extra_joints_leave_the_bone_where_it_is() -> None:
    rng = np.random.default_rng(0)
    poses, trans = rng.normal(0, 0.6, (4, JOINT_COUNT, 3)), rng.normal(0, 1, (4, 3))
    joints = _on_forearm((-1, 0), (-0.5, 0.5), (0, 1))
    matrices = skinning_matrices(poses, trans, REST_JOINTS, joints)
    for point in (REST_JOINTS[ELBOW], REST_JOINTS[WRIST]):
        carried = matrices[..., :3] @ point + matrices[..., 3]
        for extra in range(JOINT_COUNT, JOINT_COUNT + 3):
            np.testing.assert_allclose(carried[:, extra], carried[:, ELBOW], atol=1e-5)
