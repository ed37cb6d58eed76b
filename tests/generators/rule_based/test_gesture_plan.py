"""The plan: strokes end at accents, and each hand does one thing at a time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from generators.interface import SpeechSegment
from generators.rule_based.body_pose import pose_body
from generators.rule_based.emotion_style import STYLES
from generators.rule_based.gesture_plan import HANDS, Gesture, endings, plan_gestures
from generators.rule_based.hand_pose import BEFORE_THE_WAIST, CLASPED_OVER, CLASPED_UNDER, HELD_OFF
from generators.rule_based.resting import Rest, plan_rests
from motion.prosody import Prosody, prosody
from motion.segment import EMOTIONS
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from tests.generators.rule_based.test_body_pose import still


def heard(accents: np.ndarray, prominence: np.ndarray) -> Prosody:
    frames = 300
    return Prosody(
        frame_rate=30.0,
        energy=np.zeros(frames),
        pitch=np.full(frames, np.nan),
        voiced=np.zeros(frames, bool),
        syllables=accents,
        accents=accents,
        prominence=prominence,
        pauses=np.zeros((0, 2)),
    )


@st.composite
def prosodies(draw: st.DrawFn) -> Prosody:
    gaps = draw(st.lists(st.floats(0.12, 3.0), min_size=0, max_size=30))
    strengths = draw(st.lists(st.floats(0.1, 1.0), min_size=len(gaps), max_size=len(gaps)))
    return heard(np.cumsum(gaps), np.array(strengths))


@settings(max_examples=60)
@given(prosodies(), st.sampled_from(EMOTIONS), st.integers(0, 1000))
def test_phases_follow_each_other_and_hands_do_one_thing_at_a_time(
    prosody: Prosody, emotion: str, seed: int
) -> None:
    manner = STYLES[emotion].gestures
    gestures = plan_gestures(prosody, manner, np.random.default_rng(seed))
    for gesture in gestures:
        assert -1e-9 <= gesture.begin < gesture.stroke < gesture.apex
        # At the accent: within 50 ms, and never after it.
        assert 0 <= (prosody.accents - gesture.apex)[prosody.accents >= gesture.apex].min() < 0.05
    for hand in HANDS:
        own = [gesture for gesture in gestures if hand in gesture.hands]
        for gesture, ending, following in zip(
            own, endings(own, manner.tempo), own[1:], strict=False
        ):
            assert gesture.apex < ending.release <= following.begin + 1e-9
            if ending.rest is not None:
                assert ending.release < ending.rest <= following.begin + 1e-9


@settings(max_examples=40)
@given(prosodies(), st.sampled_from(EMOTIONS), st.integers(0, 1000))
def test_strokes_keep_the_emotions_distance_and_forms(
    prosody: Prosody, emotion: str, seed: int
) -> None:
    manner = STYLES[emotion].gestures
    gestures = plan_gestures(prosody, manner, np.random.default_rng(seed))
    apexes = np.array([gesture.apex for gesture in gestures])
    assert (np.diff(apexes) >= manner.least_gap - 1e-9).all()
    for gesture in gestures:
        allowed = gesture.form.both_hands if len(gesture.hands) == 2 else gesture.form.one_hand
        assert allowed


Plan = tuple[tuple[Gesture, ...], tuple[Rest, ...]]
SECONDS = 12.0


def planned(speech_heard: Prosody, emotion: str, seed: int) -> Plan:
    manner = STYLES[emotion].gestures
    rng = np.random.default_rng(seed)
    gestures = plan_gestures(speech_heard, manner, rng)
    return gestures, plan_rests(manner, gestures, SECONDS, rng)


@pytest.fixture(scope="module")
def speech_heard(speak: Callable[..., SpeechSegment]) -> Prosody:
    return prosody(speak("a", SECONDS, "neutral", 1).audio, 30)


@pytest.fixture(scope="module")
def plans(speech_heard: Prosody) -> list[Plan]:
    return [planned(speech_heard, "neutral", seed) for seed in range(40)]


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
