"""Cepstral coefficients tell colours of sound apart, and only what is near."""

from __future__ import annotations

import numpy as np
from scipy.fft import dct

from motion.audio import Audio
from training.hearing.mel import mel_bands
from training.hearing.mfcc import COEFFICIENTS, WIDTH, log_mel, mfcc

NOISE = Audio(np.random.default_rng(1).normal(0, 0.1, 32000).astype(np.float32), 16000)


def test_two_rows_of_coefficients_and_their_changes_make_a_frame() -> None:
    found = mfcc(NOISE, 15)
    assert found.shape == (30, WIDTH)
    rows = found.reshape(60, 3, COEFFICIENTS)
    bands = np.log10(mel_bands(NOISE, 30).astype(float))
    np.testing.assert_allclose(rows[:, 0], dct(bands, norm="ortho")[:, :14], atol=1e-4)
    np.testing.assert_allclose(rows[1:-1, 1], (rows[2:, 0] - rows[:-2, 0]) / 2, atol=1e-4)
    np.testing.assert_allclose(rows[2:-2, 2], (rows[3:-1, 1] - rows[1:-3, 1]) / 2, atol=1e-4)


def test_silence_is_finite_and_a_spectrogram_is_logarithms() -> None:
    assert np.isfinite(mfcc(Audio(np.zeros(8000, np.float32), 16000), 15)).all()
    np.testing.assert_allclose(log_mel(NOISE, 15), np.log10(mel_bands(NOISE, 15)), rtol=1e-5)


def test_what_is_far_away_changes_nothing() -> None:
    other = NOISE.samples.copy()
    other[:8000] = 0
    changed = mfcc(Audio(other, 16000), 15)
    np.testing.assert_allclose(changed[10:], mfcc(NOISE, 15)[10:], atol=1e-4)
