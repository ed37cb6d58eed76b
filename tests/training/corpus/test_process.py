from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from motion.audio import Audio
from motion.errors import InputError
from motion.segment import EMOTIONS
from tests.generators.conftest import syllables
from training.corpus.chance import EXPECTED, Chance
from training.corpus.motion_curves import (
    MotionCurves,
    correlate_motions,
    curves_of,
    wrist_positions,
)
from training.corpus.process import Process, drive
from training.corpus.speakers import speaker_of
from training.corpus.speech_curves import SpeechCurves, find_strokes

SPEAKER = speaker_of(1, 1)


@pytest.fixture(scope="module")
def speech() -> Audio:
    return syllables(6.0, 3)


@pytest.fixture(scope="module")
def process(speech: Audio) -> Process:
    return Process.from_speech(speech, "neutral", SPEAKER)


def correlation(curve: str, one: MotionCurves, other: MotionCurves) -> float:
    return next(
        result.correlation for result in correlate_motions(one, other) if result.curve == curve
    )


def test_the_drive_is_the_same_curve_at_any_frame_rate(process: Process) -> None:
    slow, fast = process.drive(15.0), process.drive(60.0)
    for field in dataclasses.fields(MotionCurves):
        a, b = getattr(slow, field.name), getattr(fast, field.name)[::4]
        if field.name != "wrist_speed":  # differences of positions, which depend on the step
            np.testing.assert_allclose(a, b, atol=1e-9)
        assert np.corrcoef(a, b)[0, 1] > 0.9


def test_takes_follow_the_speech_and_differ_by_chance(process: Process) -> None:
    expected = process.drive(30.0)
    takes = []
    for seed in range(6):
        chance = Chance(seed=(seed,))
        takes.append(curves_of(process.body(30.0, chance), process.face(30.0, chance), 30.0))
    follow = [correlation("wrist_speed", take, expected) for take in takes]
    assert 0.5 < np.mean(follow) < 0.95
    between = [correlation("wrist_speed", takes[0], take) for take in takes[1:]]
    assert max(between) < 0.98


def test_other_speech_drives_another_motion(process: Process) -> None:
    chance = Chance(seed=(1,))
    curves = curves_of(process.body(30.0, chance), process.face(30.0, chance), 30.0)
    own_correlation = correlation("wrist_speed", curves, process.drive(30.0))
    others = [
        correlation("wrist_speed", curves, drive(syllables(6.0, seed), "neutral", SPEAKER, 30.0))
        for seed in (11, 12, 13, 14)
    ]
    assert own_correlation > max(others) + 0.2


def test_silence_calls_for_no_stroke_and_the_hands_rest() -> None:
    silence = Audio(np.zeros(32000, np.float32), 16000)
    curves = drive(silence, "neutral", SPEAKER, 30.0)
    assert curves.wrist_speed.max() < 1e-6
    assert np.ptp(curves.jaw_open) < 1e-6


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


def test_a_curve_that_does_not_change_has_no_correlation_but_a_reason(process: Process) -> None:
    still = curves_of(np.zeros((180, 141)), np.zeros((180, 51)), 30.0)
    for result in correlate_motions(still, process.drive(30.0)):
        assert np.isnan(result.correlation)
        assert "does not change" in result.reason


@pytest.mark.parametrize(
    ("audio", "emotion", "rate", "complaint"),
    [
        (Audio(np.zeros(8000, np.float32), 8000), "neutral", 30.0, "8000 Hz"),
        (Audio(np.zeros(100, np.float32), 16000), "neutral", 30.0, "0.01 s"),
        (Audio(np.zeros(16000, np.float32), 16000), "boredom", 30.0, "boredom"),
        (Audio(np.zeros(16000, np.float32), 16000), "neutral", 0.0, "frame rate"),
    ],
)
def test_unusable_arguments_are_refused(
    audio: Audio, emotion: str, rate: float, complaint: str
) -> None:
    with pytest.raises(InputError, match=complaint):
        drive(audio, emotion, SPEAKER, rate)


def test_without_chance_the_process_is_its_mean() -> None:
    drawn = [Chance(seed=(seed,)).strokes(40) for seed in range(400)]
    expected = EXPECTED.strokes(40)
    gains = np.mean([one.gains for one in drawn], axis=(0, 1))
    np.testing.assert_allclose(gains, expected.gains[0], rtol=0.03)
    assert np.mean([one.delays for one in drawn]) == pytest.approx(0, abs=0.001)
    times = np.arange(30) / 10
    assert not EXPECTED.drift(times, 3, 1).any()
    assert not len(EXPECTED.blinks(100.0))


def test_drift_has_the_stated_mean_and_variance_at_any_frame_rate() -> None:
    chance = Chance(seed=(1, 2))
    slow, fast = (chance.drift(np.arange(rate * 600) / rate, 50, 1) for rate in (10, 20))
    np.testing.assert_allclose(fast[::2], slow, atol=1e-9)
    assert slow.mean() == pytest.approx(0, abs=0.02)
    assert slow.var() == pytest.approx(1, rel=0.05)


def speech_with_humps(peaks: dict[float, float], seconds: float = 4.0) -> SpeechCurves:
    """Return speech whose loudness has a hump of 0.2 s at each of the times, so high."""
    times = np.arange(round(100 * seconds)) / 100
    loudness = np.zeros(len(times))
    for moment, height in peaks.items():
        loudness += height * np.exp(-0.5 * ((times - moment) / 0.05) ** 2)
    nothing = np.zeros(len(times))
    return SpeechCurves(
        loudness=loudness,
        slow_loudness=nothing,
        pitch=nothing,
        sounding=nothing,
        brightness=nothing,
    )


def test_a_stroke_arrives_where_the_voice_rises_to_a_loud_syllable() -> None:
    result = find_strokes(speech_with_humps({1.0: 0.9, 2.5: 0.7}), spacing=0.4)
    # A Gaussian rises fastest one sigma before its peak.
    np.testing.assert_allclose(result.times, [0.95, 2.45], atol=0.011)
    np.testing.assert_allclose(result.sizes, [1.6 * (0.9 - 0.35), 1.6 * (0.7 - 0.35)], rtol=1e-3)


def test_of_near_syllables_the_louder_gets_the_stroke() -> None:
    result = find_strokes(speech_with_humps({1.0: 0.7, 1.3: 0.9, 2.5: 0.6}), spacing=0.5)
    np.testing.assert_allclose(result.times, [1.25, 2.45], atol=0.011)
