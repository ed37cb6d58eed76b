"""The whole rule-based motion: in time with the voice, in an emotion's manner, alive."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import find_peaks

from analysis.metrics.self_penetration import PenetrableBody
from generators.interface import SpeechSegment
from generators.rule_based.generator import RuleBased
from motion.audio import Audio, read_audio
from motion.body.model import read_body
from motion.clip import MotionClip, arkit_index
from motion.prosody import prosody
from motion.segment import EMOTIONS, Segment
from motion.skeleton import REST_JOINTS, forward_kinematics, joint_index
from renderer.look import default_body
from tests.motion.random_clips import arkit_of

Speak = Callable[..., SpeechSegment]
Clips = dict[tuple[str, int], tuple[SpeechSegment, MotionClip]]
RATE = 30
SEEDS = (0, 1)
SECONDS = 8.0
WRISTS = [joint_index("left_wrist"), joint_index("right_wrist")]


def joints_of(clip: MotionClip) -> np.ndarray:
    return forward_kinematics(clip.poses, clip.trans, REST_JOINTS)[0]


def wrist_speed(clip: MotionClip) -> np.ndarray:
    """Speed of the faster wrist in m/s between frames, shape (T - 1,)."""
    steps = np.linalg.norm(np.diff(joints_of(clip)[:, WRISTS], axis=0), axis=2)
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
def clips(speak: Speak) -> Clips:
    """Speech and motion of each emotion for two seeds, 8 s long."""
    made = {}
    for emotion in EMOTIONS:
        for seed in SEEDS:
            speech = speak("a", SECONDS, emotion, seed)
            made[emotion, seed] = speech, generate(speech, seed)
    return made


def as_segment(audio: Audio, emotion: str) -> SpeechSegment:
    segment = Segment(
        name="s", wav="s.wav", start=0, end=audio.duration, speaker="scott", emotion=emotion
    )
    return SpeechSegment(segment=segment, audio=audio)


def share_near(moments: np.ndarray, accents: np.ndarray) -> float:
    """Share of `accents` with a moment within 50 ms."""
    return float((np.abs(accents[:, None] - moments).min(axis=1) <= 0.05).mean())


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_hands_stop_on_the_strongest_accents(clips: Clips, emotion: str) -> None:
    met, by_chance = [], []
    for seed in SEEDS:
        speech, clip = clips[emotion, seed]
        moments, accents = stops(clip), prosody(speech.audio, RATE)
        strong = accents.accents[accents.prominence > 0.6]
        met.append(share_near(moments, strong))
        shifts = np.random.default_rng(0).uniform(1, SECONDS - 1, 100)
        by_chance += [share_near((moments + shift) % SECONDS, strong) for shift in shifts]
    assert np.mean(met) > 1.6 * np.mean(by_chance)


def test_hands_and_jaw_follow_a_real_voice(shared_data: Path) -> None:
    audio = read_audio(shared_data / "2_scott_0_2_2.wav").cut(0, 30)
    clip = generate(as_segment(audio, "neutral"))
    heard = prosody(audio, RATE)
    moments, strong = stops(clip), heard.accents[heard.prominence > 0.4]
    shifts = np.random.default_rng(0).uniform(1, 29, 100)
    chance = np.mean([share_near((moments + shift) % 30, strong) for shift in shifts])
    assert share_near(moments, strong) > max(0.6, 2 * float(chance))
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
    depths, joints = body.depths(clip), joints_of(clip)
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
        emotion: joints_of(clips[emotion, 0][1])[:, :, 1].mean(axis=0)
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
    clip = generate(as_segment(Audio(np.zeros(5 * 16000, np.float32), 16000), "anger"))
    assert wrist_speed(clip).max() < 0.15
