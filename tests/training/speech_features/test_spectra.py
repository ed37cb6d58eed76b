"""The filterbank that AMUSE's encoders read."""

from __future__ import annotations

import librosa
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.fft import dct

from motion.audio import Audio
from motion.errors import InputError
from training.speech_features.spectra import (
    BANDS,
    COEFFICIENTS,
    RATE,
    WIDTH,
    WINDOW,
    check_speech,
    filterbank,
    log_mel,
    mel_bands,
    mfcc,
)


def _tone(hertz: float, seconds: float) -> NDArray[np.float32]:
    times = np.arange(round(16_000 * seconds)) / 16_000
    return (0.5 * np.sin(2 * np.pi * hertz * times)).astype(np.float32)


def test_ten_seconds_have_998_rows_and_zeros_follow() -> None:
    rows = filterbank(_tone(440, 10.0))
    padding = 9.173025 / (2 * 5.062332)
    assert tuple(rows.shape) == (1024, 128)
    assert rows[998:].numpy() == pytest.approx(padding)
    assert (rows[:998] != rows[998]).any(dim=1).all()


@pytest.mark.parametrize(
    ("samples", "message"),
    [(_tone(440, 0.3), "0.30 s, too short"), (np.zeros(16_000, np.float32), "is silent")],
)
def test_samples_without_speech_are_refused(samples: NDArray[np.float32], message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_speech(samples)


def noise(seconds: float, rate: int = RATE, seed: int = 1) -> Audio:
    rng = np.random.default_rng(seed)
    return Audio((0.1 * rng.standard_normal(round(seconds * rate))).astype(np.float32), rate)


@pytest.mark.parametrize("rate", [15, 30])
def test_bands_are_those_that_librosa_gives_by_default(rate: int) -> None:
    speech = noise(2.0)
    theirs = librosa.feature.melspectrogram(
        y=speech.samples.astype(float), sr=RATE, n_fft=WINDOW, hop_length=RATE // rate, n_mels=BANDS
    )
    np.testing.assert_allclose(mel_bands(speech, rate), theirs.T[: 2 * rate], rtol=1e-4)


def test_another_sampling_rate_puts_a_tone_into_the_same_band_with_the_same_power() -> None:
    tones = [
        Audio(np.sin(2 * np.pi * 440 * np.arange(2 * rate) / rate).astype(np.float32), rate)
        for rate in (RATE, 16000, 44100)
    ]
    known, *others = (mel_bands(tone, 15)[15] for tone in tones)
    for other in others:
        assert other.argmax() == known.argmax()
        assert other.max() == pytest.approx(known.max(), rel=0.01)


@pytest.mark.parametrize("frame_rate", [0, -15, 29.97])
def test_a_frame_rate_that_does_not_divide_the_sound_is_refused(frame_rate: float) -> None:
    with pytest.raises(InputError, match="such as 15 or 30"):
        mel_bands(noise(1.0), frame_rate)


NOISE = Audio(np.random.default_rng(1).normal(0, 0.1, 32000).astype(np.float32), 16000)


def test_two_rows_of_coefficients_and_their_changes_make_a_frame() -> None:
    result = mfcc(NOISE, 15)
    assert result.shape == (30, WIDTH)
    rows = result.reshape(60, 3, COEFFICIENTS)
    bands = np.log10(mel_bands(NOISE, 30).astype(float))
    np.testing.assert_allclose(rows[:, 0], dct(bands, norm="ortho")[:, :14], atol=1e-4)
    np.testing.assert_allclose(rows[1:-1, 1], (rows[2:, 0] - rows[:-2, 0]) / 2, atol=1e-4)
    np.testing.assert_allclose(rows[2:-2, 2], (rows[3:-1, 1] - rows[1:-3, 1]) / 2, atol=1e-4)


def test_silence_is_finite_and_a_spectrogram_is_logarithms() -> None:
    assert np.isfinite(mfcc(Audio(np.zeros(8000, np.float32), 16000), 15)).all()
    np.testing.assert_allclose(log_mel(NOISE, 15), np.log10(mel_bands(NOISE, 15)), rtol=1e-5)
