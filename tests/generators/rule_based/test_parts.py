"""The parts of rule-based motion: hands where they should be, the mouth of vowels, the plan."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from generators.interface import SpeechSegment
from generators.rule_based.body_pose import Trunk, pose_body
from generators.rule_based.face_motion import speaking_mouth
from generators.rule_based.gesture_plan import HANDS, endings, plan_gestures
from generators.rule_based.hand_tracks import plan_rests
from generators.rule_based.vocabulary import FORMS, POSES, STYLES, HandPose
from motion.audio import Audio
from motion.prosody import Prosody, prosody
from motion.segment import EMOTIONS
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


RATE = 16000
FRAME_RATE = 30


def vowel(formants: tuple[float, float], seconds: float = 1.0) -> np.ndarray:
    """A buzz at 120 Hz whose harmonics near the formants are strong."""
    times = np.arange(round(seconds * RATE)) / RATE
    wave = np.zeros_like(times)
    for k in range(1, 30):
        gain = sum(np.exp(-(((120 * k - formant) / 150) ** 2)) for formant in formants)
        wave += (0.02 + gain) * np.sin(2 * np.pi * 120 * k * times)
    return 0.1 * wave


def test_vowels_shape_the_lips() -> None:
    vowels = [vowel((750, 1100)), vowel((300, 2200)), vowel((320, 650))]
    audio = Audio(np.concatenate(vowels).astype(np.float32), RATE)
    speech = prosody(audio, FRAME_RATE)
    shapes = speaking_mouth(audio, speech, np.arange(len(speech.energy)) / FRAME_RATE, 1.0)
    open_vowel, spread, rounded = slice(8, 22), slice(38, 52), slice(68, 82)
    assert shapes["jawOpen"][open_vowel].mean() > 1.5 * shapes["jawOpen"][spread].mean()
    assert shapes["mouthStretch"][spread].mean() > 2 * shapes["mouthStretch"][rounded].mean()
    assert shapes["mouthPucker"][rounded].mean() > 2 * shapes["mouthPucker"][spread].mean()


@st.composite
def prosodies(draw: st.DrawFn) -> Prosody:
    gaps = draw(st.lists(st.floats(0.12, 3.0), min_size=0, max_size=30))
    strengths = draw(st.lists(st.floats(0.1, 1.0), min_size=len(gaps), max_size=len(gaps)))
    accents, frames = np.cumsum(gaps), 300
    return Prosody(
        frame_rate=30.0,
        energy=np.zeros(frames),
        syllables=accents,
        accents=accents,
        prominence=np.array(strengths),
    )


@settings(max_examples=60)
@given(prosodies(), st.sampled_from(EMOTIONS), st.integers(0, 1000))
def test_gesture_phases_follow_each_other_without_overlap(
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


def test_clasped_hands_part_when_a_gesture_starts_with_the_upper_hand(
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
