"""Tones, noise, and whether there is a voice."""

import shutil

import numpy as np
import pytest

from motion.audio import Audio

needs_espeak = pytest.mark.skipif(
    shutil.which("espeak-ng") is None, reason="espeak-ng is not installed"
)


def tone(seconds: float, hertz: float = 440, rate: int = 16_000, loud: float = 0.5) -> Audio:
    times = np.arange(round(seconds * rate)) / rate
    return Audio((loud * np.sin(2 * np.pi * hertz * times)).astype(np.float32), rate)


def noise(seconds: float, rate: int = 16_000, seed: int = 1) -> Audio:
    values = np.random.default_rng(seed).standard_normal(round(seconds * rate))
    return Audio((0.1 * values).astype(np.float32), rate)
