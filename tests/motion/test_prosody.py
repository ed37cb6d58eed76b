"""Prosody against sounds whose energy, pitch, accents and pauses are known."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motion.audio import Audio
from motion.prosody import prosody

RATE = 16000


def voice(seconds: float, pitch: float | np.ndarray, rate: int = RATE) -> np.ndarray:
    """A buzz of ten harmonics, which a pitch tracker hears as a voice."""
    times = np.arange(round(seconds * rate)) / rate
    phase = 2 * np.pi * np.cumsum(np.broadcast_to(pitch, times.shape)) / rate
    return np.asarray(0.2 * np.sum([np.sin(k * phase) / k for k in range(1, 11)], axis=0))


def syllables(
    seconds: float,
    at: Sequence[float],
    loudness: Sequence[float],
    pitch: float | np.ndarray = 120.0,
) -> np.ndarray:
    """Humps of voice, 0.2 s long, that peak at the times `at`."""
    times = np.arange(round(seconds * RATE)) / RATE
    humps = [
        loud * np.cos(np.clip((times - peak) / 0.2, -0.5, 0.5) * np.pi) ** 2
        for peak, loud in zip(at, loudness, strict=True)
    ]
    return np.asarray(voice(seconds, pitch) * np.max(humps, axis=0))


def audio(samples: np.ndarray, rate: int = RATE) -> Audio:
    return Audio(samples.astype(np.float32), rate)


def test_energy_falls_by_decibels() -> None:
    softer = 10 ** (-17.5 / 20)
    result = prosody(audio(np.concatenate([voice(1, 120), softer * voice(1, 120)])), 50)
    assert result.energy[60:90].mean() == pytest.approx(0.5, abs=0.03)


def test_accents_are_the_louder_syllables_at_their_peaks() -> None:
    at = [0.4, 0.8, 1.2, 1.6, 2.0, 2.4]
    loud = [1.0, 0.35, 1.0, 0.35, 1.0, 0.35]
    result = prosody(audio(syllables(2.8, at, loud)), 30)
    np.testing.assert_allclose(result.syllables, at, atol=0.03)
    np.testing.assert_allclose(result.accents, [0.4, 1.2, 2.0], atol=0.03)
    assert result.prominence.max() == 1
    assert result.prominence.min() > 0


def test_a_rise_of_pitch_makes_an_accent_among_equally_loud_syllables() -> None:
    at = [0.4, 0.8, 1.2, 1.6, 2.0]
    times = np.arange(round(2.4 * RATE)) / RATE
    pitch = np.where(np.abs(times - 1.2) < 0.15, 170.0, 120.0)
    result = prosody(audio(syllables(2.4, at, [1.0] * 5, pitch)), 30)
    strongest = result.accents[np.argmax(result.prominence)]
    assert strongest == pytest.approx(1.2, abs=0.03)


def test_silence_has_no_accent() -> None:
    result = prosody(audio(np.zeros(2 * RATE)), 30)
    assert not result.energy.any()
    assert len(result.accents) == len(result.prominence) == 0


@settings(max_examples=25, deadline=None)
@given(samples=st.integers(1700, 9000), frame_rate=st.floats(10, 120), seed=st.integers(0, 2**16))
def test_energy_has_one_value_per_frame(samples: int, frame_rate: float, seed: int) -> None:
    sound = audio(np.random.default_rng(seed).normal(0, 0.1, samples).clip(-1, 1))
    result = prosody(sound, frame_rate)
    frames = round(sound.duration * frame_rate)
    assert len(result.energy) == frames
    assert result.energy.min() >= 0 and result.energy.max() <= 1
    assert (np.diff(result.accents) > 0).all()
