"""The plan: strokes end at accents, and each hand does one thing at a time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from generators.interface import SpeechSegment
from generators.rule_based.emotion_style import STYLES
from generators.rule_based.gesture_plan import HANDS, endings, plan_gestures
from generators.rule_based.hand_pose import POSES
from generators.rule_based.resting import plan_rests
from motion.prosody import Prosody, prosody
from motion.segment import EMOTIONS


@st.composite
def prosodies(draw: st.DrawFn) -> Prosody:
    gaps = draw(st.lists(st.floats(0.12, 3.0), min_size=0, max_size=30))
    strengths = draw(st.lists(st.floats(0.1, 1.0), min_size=len(gaps), max_size=len(gaps)))
    accents, frames = np.cumsum(gaps), 300
    return Prosody(
        frame_rate=30.0,
        energy=np.zeros(frames),
        pitch=np.full(frames, np.nan),
        voiced=np.zeros(frames, bool),
        syllables=accents,
        accents=accents,
        prominence=np.array(strengths),
        pauses=np.zeros((0, 2)),
    )


@settings(max_examples=60)
@given(prosodies(), st.sampled_from(EMOTIONS), st.integers(0, 1000))
def test_phases_follow_each_other_and_hands_do_one_thing_at_a_time(
    prosody: Prosody, emotion: str, seed: int
) -> None:
    manner = STYLES[emotion].gestures
    gestures = plan_gestures(prosody, manner, np.random.default_rng(seed))
    for gesture in gestures:
        assert -1e-9 <= gesture.begin < gesture.stroke < gesture.apex
        assert gesture.form.both_hands if len(gesture.hands) == 2 else gesture.form.one_hand
        # At the accent: within 50 ms, and never after it.
        assert 0 <= (prosody.accents - gesture.apex)[prosody.accents >= gesture.apex].min() < 0.05
    apexes = np.array([gesture.apex for gesture in gestures])
    assert (np.diff(apexes) >= manner.least_gap - 1e-9).all()
    for hand in HANDS:
        own = [gesture for gesture in gestures if hand in gesture.hands]
        for gesture, ending, following in zip(
            own, endings(own, manner.tempo), own[1:], strict=False
        ):
            assert gesture.apex < ending.release <= following.begin + 1e-9
            if ending.rest is not None:
                assert ending.release < ending.rest <= following.begin + 1e-9


SECONDS = 12.0


def test_clasped_hands_part_when_the_next_gesture_begins_with_the_one_on_top(
    speak: Callable[..., SpeechSegment],
) -> None:
    manner, clasps = STYLES["neutral"].gestures, 0
    speech_prosody = prosody(speak("a", SECONDS, "neutral", 1).audio, 30)
    for seed in range(40):
        chance = np.random.default_rng(seed)
        gestures = plan_gestures(speech_prosody, manner, chance)
        rests = plan_rests(manner, gestures, SECONDS, chance)
        for rest, after in zip(rests, [*rests[1:], None], strict=True):
            upcoming = next((one for one in gestures if one.begin >= rest.begin), None)
            if not rest.clasped or upcoming is None:
                continue
            clasps += 1
            assert after is not None
            assert rest.begin <= after.begin <= upcoming.begin
            on_top = next(hand for hand in HANDS if rest.poses[hand] is POSES["clasped_over"])
            assert on_top in upcoming.hands
    assert clasps > 3
