"""Trunk and hand channels become joints: where they should be, alike on both sides."""

from __future__ import annotations

import numpy as np
import pytest

from generators.rule_based.body_pose import Trunk, pose_body
from generators.rule_based.emotion_style import STYLES
from generators.rule_based.gesture_plan import FORMS
from generators.rule_based.hand_pose import POSES, HandPose
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index


def still() -> Trunk:
    zeros, flat = np.zeros((1, 3)), np.zeros(1)
    return Trunk(
        pelvis=zeros, spine=zeros, head=zeros, shift=zeros,
        shoulders_up=flat, shoulders_forward=flat,
    )  # fmt: skip


ALL_HANDS = {name: form.apex for name, form in FORMS.items()} | {
    f"rest of {emotion}": style.gestures.rest for emotion, style in STYLES.items()
}


@pytest.mark.parametrize("hand", ALL_HANDS.values(), ids=ALL_HANDS)
def test_the_wrist_has_the_hand_poses_position_and_both_sides_mirror_each_other(
    hand: HandPose,
) -> None:
    channels = hand.channels()[None]
    poses, trans = pose_body(still(), {"left": channels, "right": channels})
    (joints,), _ = forward_kinematics(poses, trans, REST_JOINTS)
    for name in ("elbow", "wrist", "index3", "thumb3", "pinky3", "knee"):
        left, right = (joints[joint_index(f"{side}_{name}")] for side in ("left", "right"))
        np.testing.assert_allclose(left, right * (-1, 1, 1), atol=1e-6)
    shoulder = REST_JOINTS[joint_index("left_shoulder")]
    arm = abs(REST_JOINTS[joint_index("left_wrist"), 0] - shoulder[0])
    expected = shoulder + arm * np.array([hand.outward, hand.up, hand.forward])
    assert np.linalg.norm(joints[joint_index("left_wrist")] - expected) < 0.03


def test_clasped_hands_lie_on_each_other() -> None:
    over, under = (POSES[f"clasped_{name}"].channels()[None] for name in ("over", "under"))
    poses, trans = pose_body(still(), {"left": under, "right": over})
    (joints,), _ = forward_kinematics(poses, trans, REST_JOINTS)
    left, right = (joints[joint_index(f"{side}_middle1")] for side in ("left", "right"))
    assert 0.03 < np.linalg.norm(left - right) < 0.09
    assert right[2] > left[2]
