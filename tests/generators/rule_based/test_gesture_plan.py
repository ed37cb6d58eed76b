"""The plan: strokes end at accents, and each hand does one thing at a time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from generators.rule_based.emotion_style import STYLES
from generators.rule_based.gesture_plan import HANDS, endings, plan_gestures
from motion.prosody import Prosody
from motion.segment import EMOTIONS


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


def test_a_stroke_begins_on_a_syllable_where_one_is_near() -> None:
    manner, accents = STYLES["neutral"].gestures, np.arange(1, 9) * 1.2
    plain = plan_gestures(heard(accents, np.ones(8)), manner, np.random.default_rng(0))
    near = np.array([gesture.stroke for gesture in plain]) + 0.03 + 0.04
    syllables = np.sort(np.concatenate([accents, near]))
    prosody = replace(heard(accents, np.ones(8)), syllables=syllables)
    snapped = plan_gestures(prosody, manner, np.random.default_rng(0))
    np.testing.assert_allclose([gesture.stroke for gesture in snapped], near - 0.03)


def test_over_many_seeds_left_right_and_both_hands_gesture() -> None:
    prosody = heard(np.arange(1, 9, 0.8), np.ones(10))
    used = {
        gesture.hands
        for seed in range(10)
        for gesture in plan_gestures(
            prosody, STYLES["neutral"].gestures, np.random.default_rng(seed)
        )
    }
    assert used == {("left",), ("right",), ("left", "right")}
