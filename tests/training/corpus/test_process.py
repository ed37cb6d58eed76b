import dataclasses

import numpy as np
import pytest

from motion.audio import Audio
from motion.segment import EMOTIONS
from tests.generators.conftest import syllables
from training.corpus.chance import EXPECTED, Chance
from training.corpus.process import Process
from training.corpus.speakers import speaker_of
from training.corpus.speech_curves import SpeechCurves, find_strokes
from training.corpus.truth import MotionCurves, curves_of, wrist_positions

SPEAKER = speaker_of(1, 1)


@pytest.fixture(scope="module")
def speech() -> Audio:
    return syllables(6.0, 3)


@pytest.fixture(scope="module")
def process(speech: Audio) -> Process:
    return Process.from_speech(speech, "neutral", SPEAKER)


def drive_of(speech: Audio) -> MotionCurves:
    return Process.from_speech(speech, "neutral", SPEAKER).drive(30.0)


def test_the_drive_is_the_same_curve_at_any_frame_rate(process: Process) -> None:
    slow, fast = process.drive(15.0), process.drive(60.0)
    for field in dataclasses.fields(MotionCurves):
        a, b = getattr(slow, field.name), getattr(fast, field.name)[::4]
        if field.name != "wrist_speed":  # differences of positions, which depend on the step
            np.testing.assert_allclose(a, b, atol=1e-9)
        assert np.corrcoef(a, b)[0, 1] > 0.9


def test_takes_follow_their_own_speech_best_and_differ_by_chance(process: Process) -> None:
    takes = []
    for seed in range(6):
        chance = Chance(seed=(seed,))
        takes.append(curves_of(process.body(30.0, chance), process.face(30.0, chance), 30.0))

    def correlation(one: MotionCurves, other: MotionCurves) -> float:
        return float(np.corrcoef(one.wrist_speed, other.wrist_speed)[0, 1])

    follow = [correlation(take, process.drive(30.0)) for take in takes]
    assert 0.5 < np.mean(follow) < 0.95
    others = [drive_of(syllables(6.0, seed)) for seed in (11, 12, 13, 14)]
    assert follow[1] > max(correlation(takes[1], other) for other in others) + 0.2
    assert max(correlation(takes[0], take) for take in takes[1:]) < 0.98


def test_the_mean_over_chance_is_the_process_without_it() -> None:
    drawn = [Chance(seed=(seed,)).strokes(40) for seed in range(400)]
    expected = EXPECTED.strokes(40)
    gains = np.mean([one.gains for one in drawn], axis=(0, 1))
    np.testing.assert_allclose(gains, expected.gains[0], rtol=0.03)
    assert np.mean([one.delays for one in drawn]) == pytest.approx(0, abs=0.001)
    drift = Chance(seed=(1, 2)).drift(np.arange(12_000) / 20, 50, 1)
    assert drift.mean() == pytest.approx(0, abs=0.02)
    assert drift.var() == pytest.approx(1, rel=0.05)


def test_strokes_arrive_on_the_louder_of_nearby_syllables() -> None:
    times = np.arange(400) / 100
    peaks = {1.0: 0.7, 1.3: 0.9, 2.5: 0.6}
    loudness = sum(
        height * np.exp(-0.5 * ((times - moment) / 0.05) ** 2) for moment, height in peaks.items()
    )
    others = dict.fromkeys(("slow_loudness", "pitch", "sounding", "brightness"), 0 * times)
    speech = SpeechCurves(loudness=np.asarray(loudness), **others)
    result = find_strokes(speech, spacing=0.5)
    # A Gaussian rises fastest one sigma before its peak.
    np.testing.assert_allclose(result.times, [1.25, 2.45], atol=0.011)
    np.testing.assert_allclose(result.sizes, [1.6 * (0.9 - 0.35), 1.6 * (0.6 - 0.35)], rtol=1e-3)


@pytest.mark.parametrize(("number", "emotion"), [*enumerate(EMOTIONS, 1)])
def test_motion_is_finite_smooth_and_within_limits(
    speech: Audio, number: int, emotion: str
) -> None:
    process = Process.from_speech(speech, emotion, speaker_of(number, 1))
    chance = Chance(seed=(number,))
    body, face = process.body(60.0, chance), process.face(60.0, chance)
    assert body.shape == (360, 141)
    assert face.shape == (360, 51)
    assert face.min() >= 0
    assert face.max() <= 1
    speeds = [_wrist_speed(process.body(rate, chance), rate) for rate in (60.0, 240.0)]
    assert speeds[0].max() < 5
    # No jump: four times the frames a second, a quarter of the change between two.
    changes = [np.abs(np.diff(speed, axis=0)).max() for speed in speeds]
    assert changes[1] < 0.4 * changes[0]


def _wrist_speed(body: np.ndarray, frame_rate: float) -> np.ndarray:
    moves: np.ndarray = np.linalg.norm(np.diff(wrist_positions(body), axis=0), axis=2)
    return moves * frame_rate


def test_silence_gives_no_motion() -> None:
    still = drive_of(Audio(np.zeros(96_000, np.float32), 16_000))
    assert still.wrist_speed.max() < 1e-6
