import math
from pathlib import Path

import numpy as np
import pyloudnorm
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.audio import Audio, read_audio
from motion.synthesis import speak
from renderer.encoder import SOUND_RATE
from renderer.loudness import (
    PEAK_CEILING,
    SHORTEST,
    TARGET,
    at_common_loudness,
    integrated_loudness,
    true_peak,
)
from tests.support.sounds import needs_espeak, tone


def loudness_by_another(audio: Audio) -> float:
    """Return the loudness in LUFS by pyloudnorm, which shares no code with FFmpeg."""
    meter = pyloudnorm.Meter(audio.sample_rate)
    return float(meter.integrated_loudness(audio.samples.astype(np.float64)))


@needs_espeak
@pytest.mark.parametrize(("emotion", "amplitude"), [("anger", 1.0), ("sadness", 0.02)])
def test_speech_of_any_level_reaches_the_target_by_another_meter(
    tmp_path: Path, emotion: str, amplitude: float
) -> None:
    text = "I walked along the river this morning, and everybody was already there."
    speak(text, emotion, tmp_path / "a.wav")
    speech = read_audio(tmp_path / "a.wav", sample_rate=SOUND_RATE)
    level = Audio(speech.samples * np.float32(amplitude), speech.sample_rate)
    result = at_common_loudness(level)
    assert loudness_by_another(result) == pytest.approx(TARGET, abs=0.1)
    assert true_peak(result) <= PEAK_CEILING


@given(amplitude=st.floats(0.001, 1.0), hertz=st.floats(80, 8000))
def test_nothing_but_the_gain_changes(amplitude: float, hertz: float) -> None:
    audio = tone(0.6, hertz, SOUND_RATE, amplitude)
    result = at_common_loudness(audio)
    loudest = np.abs(audio.samples).argmax()
    gain = result.samples[loudest] / audio.samples[loudest]
    assert len(result.samples) == len(audio.samples)
    np.testing.assert_allclose(result.samples, gain * audio.samples, rtol=1e-4, atol=1e-6)
    assert true_peak(result) <= PEAK_CEILING + 0.01


def test_peaks_stay_below_the_ceiling() -> None:
    clicks = np.zeros(2 * SOUND_RATE, np.float32)
    clicks[:: SOUND_RATE // 10] = 0.9
    result = at_common_loudness(Audio(clicks, SOUND_RATE))
    assert true_peak(result) == pytest.approx(PEAK_CEILING, abs=0.01)


@pytest.mark.parametrize(("seconds", "amplitude"), [(SHORTEST - 0.05, 0.5), (2, 0), (2, 1e-5)])
def test_sound_without_measurable_loudness_is_unchanged(seconds: float, amplitude: float) -> None:
    audio = tone(seconds, 997, SOUND_RATE, amplitude)
    result = at_common_loudness(audio)
    assert result.samples.tobytes() == audio.samples.tobytes()
    assert integrated_loudness(audio) is None


def test_a_peak_between_two_samples_is_found() -> None:
    # At a quarter of the sample rate and an eighth of a turn, samples miss the crest by 3 dB.
    turns = np.arange(4800) / 4 + 1 / 8
    audio = Audio(np.sin(2 * np.pi * turns).astype(np.float32), SOUND_RATE)
    assert 20 * math.log10(np.abs(audio.samples).max()) == pytest.approx(-3.01, abs=0.01)
    assert true_peak(audio) > -0.5
