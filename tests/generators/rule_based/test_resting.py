"""Hands rest in several ways, and lie on each other only where neither gestures."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from generators.interface import SpeechSegment
from generators.rule_based.body_pose import pose_body
from generators.rule_based.emotion_style import STYLES
from generators.rule_based.gesture_plan import HANDS, Gesture, plan_gestures
from generators.rule_based.hand_pose import (
    BEFORE_THE_WAIST,
    CLASPED_OVER,
    CLASPED_UNDER,
    HELD_OFF,
)
from generators.rule_based.resting import Rest, plan_rests
from motion.prosody import Prosody, prosody
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from tests.generators.rule_based.test_body_pose import still

Plan = tuple[tuple[Gesture, ...], tuple[Rest, ...]]
SECONDS = 12.0


def planned(heard: Prosody, emotion: str, seed: int) -> Plan:
    manner = STYLES[emotion].gestures
    rng = np.random.default_rng(seed)
    gestures = plan_gestures(heard, manner, rng)
    return gestures, plan_rests(manner, gestures, SECONDS, rng)


@pytest.fixture(scope="module")
def heard(speak: Callable[..., SpeechSegment]) -> Prosody:
    return prosody(speak("a", SECONDS, "neutral", 1).audio, 30)


@pytest.fixture(scope="module")
def plans(heard: Prosody) -> list[Plan]:
    return [planned(heard, "neutral", seed) for seed in range(40)]


def test_hands_are_clasped_or_before_the_waist_or_hang_or_one_of_them_does(
    plans: list[Plan],
) -> None:
    seen = {frozenset(rest.poses.values()) for _, rests in plans for rest in rests}
    assert seen == {
        frozenset({CLASPED_OVER, CLASPED_UNDER}),
        frozenset({BEFORE_THE_WAIST}),
        frozenset({HELD_OFF}),
        frozenset({BEFORE_THE_WAIST, HELD_OFF}),
    }


def test_clasped_hands_part_when_the_next_gesture_begins_with_the_one_on_top(
    plans: list[Plan],
) -> None:
    clasps = 0
    for gestures, rests in plans:
        begins = [rest.begin for rest in rests]
        assert [0.0, *begins[1:]] == sorted(begins)
        for rest, after in zip(rests, [*rests[1:], None], strict=True):
            upcoming = next((one for one in gestures if one.begin >= rest.begin), None)
            if not rest.clasped or upcoming is None:
                continue
            clasps += 1
            assert after is not None
            assert after.begin <= upcoming.begin
            on_top = next(hand for hand in HANDS if rest.poses[hand] is CLASPED_OVER)
            assert on_top in upcoming.hands
    assert clasps > 3


def test_clasped_hands_lie_on_each_other() -> None:
    over, under = (pose.channels()[None] for pose in (CLASPED_OVER, CLASPED_UNDER))
    poses, trans = pose_body(still(), {"left": under, "right": over})
    joints, _ = forward_kinematics(poses, trans, REST_JOINTS)
    palms = [joints[0, joint_index(f"{hand}_middle1")] for hand in HANDS]
    assert 0.03 < np.linalg.norm(palms[0] - palms[1]) < 0.09
    assert palms[1][2] > palms[0][2]
