from __future__ import annotations

import numpy as np
import pytest

from motion.face import arkit_index
from motion.rest_pose import REST_JOINTS
from motion.skeleton import forward_kinematics, joint_index
from tools.avatars.sample_poses import FIST, SAMPLE_POSES, SamplePose, sample_clip


def _joints(name: str) -> np.ndarray:
    clip = sample_clip(SAMPLE_POSES[name])
    return forward_kinematics(clip.poses, clip.trans, REST_JOINTS)[0][0]


def test_there_are_a_dozen() -> None:
    assert len(SAMPLE_POSES) == 12


def test_arms_hang_where_a_pose_says_nothing_of_them() -> None:
    joints = _joints("jaw open")
    for side in ("left", "right"):
        wrist, shoulder = (joints[joint_index(f"{side}_{part}")] for part in ("wrist", "shoulder"))
        assert wrist[1] < shoulder[1] - 0.4


def test_both_sides_are_mirror_images() -> None:
    joints = _joints("fists")
    left, right = (joints[joint_index(f"{side}_wrist")] for side in ("left", "right"))
    np.testing.assert_allclose(left * [-1, 1, 1], right, atol=1e-6)


@pytest.mark.parametrize("side", ["left", "right"])
def test_crossed_arms_reach_the_other_side_in_front_of_the_body(side: str) -> None:
    hand = _joints("arms crossed")[joint_index(f"{side}_middle3")]
    assert hand[0] * (1 if side == "left" else -1) < 0
    assert hand[2] > 0.1


def test_one_finger_can_be_bent_otherwise_than_the_rest() -> None:
    pose = SamplePose(curled={"right": FIST, "right_index": 0.1})
    poses = sample_clip(pose).poses[0]
    assert poses[joint_index("right_ring2"), 2] == pytest.approx(FIST)
    assert poses[joint_index("right_index2"), 2] == pytest.approx(0.1)


def test_a_face_named_for_both_sides_moves_both() -> None:
    arkit = sample_clip(SamplePose(face={"eyeBlinkBoth": 0.7})).arkit
    assert arkit is not None
    chosen = [arkit_index("eyeBlinkLeft"), arkit_index("eyeBlinkRight")]
    np.testing.assert_allclose(arkit[0, chosen], 0.7)
    assert arkit.sum() == pytest.approx(1.4)
