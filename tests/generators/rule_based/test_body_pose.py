"""Trunk and hand channels become joints: where they should be, alike on both sides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from generators.rule_based.body_pose import Trunk, pose_body
from generators.rule_based.emotion_style import STYLES
from generators.rule_based.gesture_forms import FORMS
from generators.rule_based.hand_pose import BEFORE_THE_WAIST, BY_THE_SIDE, HandPose
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index


def still(frames: int = 1) -> Trunk:
    zeros, flat = np.zeros((frames, 3)), np.zeros(frames)
    return Trunk(
        pelvis=zeros, spine=zeros, head=zeros, shift=zeros,
        shoulders_up=flat, shoulders_forward=flat,
    )  # fmt: skip


def posed(hand: HandPose, trunk: Trunk | None = None) -> tuple[np.ndarray, np.ndarray]:
    trunk = trunk or still()
    channels = np.tile(hand.channels(), (len(trunk.shift), 1))
    poses, trans = pose_body(trunk, {"left": channels, "right": channels})
    return forward_kinematics(poses, trans, REST_JOINTS)


def at(joints: np.ndarray, name: str) -> np.ndarray:
    return np.asarray(joints[0, joint_index(name)])


ALL_HANDS = {name: form.apex for name, form in FORMS.items()} | {
    f"rest of {emotion}": style.gestures.rest for emotion, style in STYLES.items()
}


@pytest.mark.parametrize("hand", ALL_HANDS.values(), ids=ALL_HANDS)
def test_both_sides_mirror_each_other(hand: HandPose) -> None:
    joints, _ = posed(hand)
    for name in ("elbow", "wrist", "index3", "thumb3", "pinky3", "knee"):
        left, right = at(joints, f"left_{name}"), at(joints, f"right_{name}")
        np.testing.assert_allclose(left, right * (-1, 1, 1), atol=1e-6)


@pytest.mark.parametrize("hand", ALL_HANDS.values(), ids=ALL_HANDS)
def test_the_wrist_has_the_hand_poses_position(hand: HandPose) -> None:
    joints, _ = posed(hand)
    shoulder = REST_JOINTS[joint_index("left_shoulder")]
    arm = abs(REST_JOINTS[joint_index("left_wrist"), 0] - shoulder[0])
    expected = shoulder + arm * np.array([hand.outward, hand.up, hand.forward])
    assert np.linalg.norm(at(joints, "left_wrist") - expected) < 0.03


def test_pronation_turns_the_palm_down_and_supination_up() -> None:
    palms = []
    for pronation in (-80.0, 0.0, 80.0):
        _, turns = posed(replace(BEFORE_THE_WAIST, pronation=pronation, flexion=0))
        palms.append(turns[0, joint_index("left_wrist")] @ [0, -1, 0])
    assert palms[0][1] > 0.8
    assert palms[1][0] < -0.6, "the left palm faces the body's right"
    assert palms[2][1] < -0.8


def test_the_trunk_turns_as_its_fields_say() -> None:
    rotated = replace(still(), spine=np.array([[0.0, 30.0, 0.0]]))
    _, turns = posed(BY_THE_SIDE, rotated)
    assert (turns[0, joint_index("spine3")] @ [0, 0, 1])[0] == pytest.approx(0.5, abs=1e-6)
    bent = replace(still(), spine=np.array([[30.0, 0.0, 0.0]]))
    joints, _ = posed(BY_THE_SIDE, bent)
    assert at(joints, "head")[2] > REST_JOINTS[joint_index("head"), 2] + 0.05
