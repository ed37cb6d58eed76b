"""Rule-based motion: in time with the voice, in an emotion's manner, alive; and its parts."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import find_peaks

from analysis.metrics.self_penetration import PenetrableBody
from generators.interface import SpeechSegment
from generators.rule_based.body_pose import Trunk, pose_body
from generators.rule_based.generator import RuleBased
from generators.rule_based.gesture_plan import HANDS, endings, plan_gestures
from generators.rule_based.hand_tracks import plan_rests
from generators.rule_based.vocabulary import FORMS, POSES, STYLES, HandPose
from motion.audio import Audio, read_audio
from motion.body.model import read_body
from motion.clip import MotionClip, arkit_index
from motion.prosody import Prosody, prosody
from motion.segment import EMOTIONS
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from renderer.look import default_body
from tests.generators.conftest import as_speech, spoken, syllables
from tests.motion.random_clips import arkit_of, joint_positions

Clips = dict[tuple[str, int], tuple[SpeechSegment, MotionClip]]
RATE = 30
SEEDS = (0, 1)
SECONDS = 8.0
WRISTS = [joint_index("left_wrist"), joint_index("right_wrist")]


def wrist_speed(clip: MotionClip) -> np.ndarray:
    """Speed of the faster wrist in m/s between frames, shape (T - 1,)."""
    steps = np.linalg.norm(np.diff(joint_positions(clip)[:, WRISTS], axis=0), axis=2)
    return np.asarray(steps.max(axis=1) * clip.frame_rate)


def stops(clip: MotionClip) -> np.ndarray:
    """When the hands come to a stop out of a stroke, in seconds."""
    speed = wrist_speed(clip)
    minima, _ = find_peaks(-speed)
    before = [speed[max(0, m - round(0.3 * clip.frame_rate)) : m + 1].max() for m in minima]
    fast = np.array(before) > np.maximum(0.35, 4 * speed[minima])
    return np.asarray((minima[fast] + 0.5) / clip.frame_rate)


def generate(speech: SpeechSegment, seed: int = 1, frame_rate: float = RATE) -> MotionClip:
    return RuleBased().generate(speech, seed=seed, frame_rate=frame_rate)


@pytest.fixture(scope="module")
def clips() -> Clips:
    """Speech and motion of each emotion for two seeds, 8 s long."""
    made = {}
    for emotion in EMOTIONS:
        for seed in SEEDS:
            speech = spoken("a", SECONDS, seed, emotion=emotion)
            made[emotion, seed] = speech, generate(speech, seed)
    return made


def shares_near(clip: MotionClip, accents: np.ndarray) -> tuple[float, float]:
    """Return the share of accents with a stop within 50 ms, and that by chance."""
    moments, seconds = stops(clip), clip.duration
    shifts = [0.0, *np.random.default_rng(0).uniform(1, seconds - 1, 100)]
    near, *by_chance = (
        np.mean(np.abs(accents[:, None] - (moments + shift) % seconds).min(axis=1) <= 0.05)
        for shift in shifts
    )
    return float(near), float(np.mean(by_chance))


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_hands_stop_on_the_strongest_accents(clips: Clips, emotion: str) -> None:
    shares = []
    for seed in SEEDS:
        speech, clip = clips[emotion, seed]
        accents = prosody(speech.audio, RATE)
        shares.append(shares_near(clip, accents.accents[accents.prominence > 0.6]))
    met, by_chance = np.mean(shares, axis=0)
    assert met > 1.6 * by_chance


def test_hands_and_jaw_follow_a_real_voice(shared_data: Path) -> None:
    audio = read_audio(shared_data / "2_scott_0_2_2.wav").cut(0, 30)
    clip = generate(as_speech(audio))
    heard = prosody(audio, RATE)
    met, by_chance = shares_near(clip, heard.accents[heard.prominence > 0.4])
    assert met > max(0.6, 2 * by_chance)
    jaw = arkit_of(clip)[:, arkit_index("jawOpen")]
    assert np.corrcoef(jaw, heard.energy)[0, 1] > 0.5
    assert jaw[heard.energy < 0.1].mean() < 0.03


@pytest.fixture(scope="module")
def body() -> PenetrableBody:
    return PenetrableBody.of(read_body(default_body("mannequin")))


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_limbs_move_smoothly_without_penetration_and_feet_stay(
    clips: Clips, body: PenetrableBody, emotion: str
) -> None:
    clip = clips[emotion, 1][1]
    depths, joints = body.depths(clip), joint_positions(clip)
    assert depths.max() < 0.01
    assert depths.mean() < 0.001
    hands = ("wrist", "middle1", "middle3", "index3", "pinky3")
    left, right = (
        joints[:, [joint_index(f"{side}_{part}") for part in hands]] for side in ("left", "right")
    )
    assert np.linalg.norm(left[:, :, None] - right[:, None], axis=-1).min() > 0.03
    speed = np.linalg.norm(np.diff(joints, axis=0), axis=2) * RATE
    assert speed[:, WRISTS].max() < 5
    assert speed[:, joint_index("head")].max() < 0.6
    for part in (*WRISTS, joint_index("head"), joint_index("spine3")):
        slowest_second = np.convolve(speed[:, part], np.ones(RATE) / RATE, "valid").min()
        assert slowest_second > 0.001
    assert np.abs(np.diff(clip.poses, axis=0)).max() < 0.8
    for ankle in (joint_index("left_ankle"), joint_index("right_ankle")):
        assert np.ptp(joints[:, ankle], axis=0).max() < 0.012


def test_anger_and_joy_move_more_than_neutral_and_sadness_less(clips: Clips) -> None:
    amount = {
        emotion: np.mean([wrist_speed(clips[emotion, seed][1]).mean() for seed in SEEDS])
        for emotion in EMOTIONS
    }
    assert amount["anger"] > 1.2 * amount["neutral"]
    assert amount["happiness"] > 1.2 * amount["neutral"]
    assert amount["sadness"] < 0.75 * amount["neutral"]


def test_sadness_lowers_head_and_shoulders_and_fear_raises_the_shoulders(clips: Clips) -> None:
    height = {
        emotion: joint_positions(clips[emotion, 0][1])[:, :, 1].mean(axis=0)
        for emotion in ("neutral", "sadness", "fear")
    }
    head, shoulder = joint_index("head"), joint_index("left_shoulder")
    assert height["sadness"][head] < height["neutral"][head] - 0.01
    assert height["sadness"][shoulder] < height["neutral"][shoulder] - 0.01
    assert height["fear"][shoulder] > height["neutral"][shoulder] + 0.01


@pytest.mark.parametrize(
    ("emotion", "action"),
    [
        ("happiness", "mouthSmileLeft"),
        ("anger", "browDownLeft"),
        ("sadness", "mouthFrownLeft"),
        ("contempt", "mouthDimpleRight"),
        ("surprise", "browOuterUpLeft"),
        ("fear", "mouthStretchLeft"),
        ("disgust", "noseSneerLeft"),
    ],
)
def test_each_emotion_shows_its_own_face_most(clips: Clips, emotion: str, action: str) -> None:
    index = arkit_index(action)
    strengths = {other: arkit_of(clips[other, 0][1])[:, index].mean() for other in EMOTIONS}
    assert max(strengths, key=lambda other: strengths[other]) == emotion


def test_there_are_no_gestures_in_silence() -> None:
    clip = generate(as_speech(Audio(np.zeros(5 * 16000, np.float32), 16000), emotion="anger"))
    assert wrist_speed(clip).max() < 0.15


ALL_HANDS = {name: form.apex for name, form in FORMS.items()} | {
    f"rest of {emotion}": style.gestures.rest for emotion, style in STYLES.items()
}


@pytest.mark.parametrize("hand", ALL_HANDS.values(), ids=ALL_HANDS)
def test_the_wrist_has_the_hand_poses_position_and_both_sides_mirror_each_other(
    hand: HandPose,
) -> None:
    channels = hand.channels()[None]
    poses, trans = pose_body(Trunk(), {"left": channels, "right": channels})
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
    poses, trans = pose_body(Trunk(), {"left": under, "right": over})
    (joints,), _ = forward_kinematics(poses, trans, REST_JOINTS)
    left, right = (joints[joint_index(f"{side}_middle1")] for side in ("left", "right"))
    assert 0.03 < np.linalg.norm(left - right) < 0.09
    assert right[2] > left[2]


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


def test_clasped_hands_part_when_a_gesture_starts_with_the_upper_hand() -> None:
    manner, clasps = STYLES["neutral"].gestures, 0
    speech_prosody = prosody(syllables(12.0, 1), 30)
    for seed in range(40):
        chance = np.random.default_rng(seed)
        gestures = plan_gestures(speech_prosody, manner, chance)
        rests = plan_rests(manner, gestures, 12.0, chance)
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
