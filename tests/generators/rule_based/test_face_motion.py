"""The mouth opens with the voice and closes with silence."""

from __future__ import annotations

import numpy as np
import pytest

from generators.rule_based.face_motion import blinks, gaze, speaking_mouth
from motion.audio import Audio
from motion.prosody import prosody

RATE = 16000
FRAME_RATE = 30


def mouth(samples: np.ndarray) -> dict[str, np.ndarray]:
    audio = Audio(samples.astype(np.float32), RATE)
    speech = prosody(audio, FRAME_RATE)
    times = np.arange(len(speech.energy)) / FRAME_RATE
    return dict(speaking_mouth(audio, speech, times, 1.0))


def vowel(formants: tuple[float, float], seconds: float = 1.0) -> np.ndarray:
    """A buzz at 120 Hz whose harmonics near the formants are strong."""
    times = np.arange(round(seconds * RATE)) / RATE
    wave = np.zeros_like(times)
    for k in range(1, 30):
        gain = sum(np.exp(-(((120 * k - formant) / 150) ** 2)) for formant in formants)
        wave += (0.02 + gain) * np.sin(2 * np.pi * 120 * k * times)
    return 0.1 * wave


def test_vowels_shape_the_lips() -> None:
    shapes = mouth(np.concatenate([vowel((750, 1100)), vowel((300, 2200)), vowel((320, 650))]))
    open_vowel, spread, rounded = slice(8, 22), slice(38, 52), slice(68, 82)
    assert shapes["jawOpen"][open_vowel].mean() > 1.5 * shapes["jawOpen"][spread].mean()
    assert shapes["mouthStretch"][spread].mean() > 2 * shapes["mouthStretch"][rounded].mean()
    assert shapes["mouthPucker"][rounded].mean() > 2 * shapes["mouthPucker"][spread].mean()


TIMES = np.arange(0, 600, 1 / 30)


def test_eyes_make_up_for_the_head() -> None:
    head = np.zeros((len(TIMES), 3))
    head[:, 1] = 16.0
    weights = gaze(head, 0.0, TIMES, np.random.default_rng(0))
    np.testing.assert_allclose(weights["eyeLookInLeft"], 0.5)
    np.testing.assert_allclose(weights["eyeLookOutRight"], 0.5)
    assert not weights["eyeLookOutLeft"].any()


@pytest.mark.parametrize("per_minute", [12.0, 24.0, 36.0])
def test_blinks_come_as_often_as_asked(per_minute: float) -> None:
    shut = blinks(per_minute, TIMES, np.random.default_rng(0))
    closings = ((shut[1:] > 0.5) & (shut[:-1] <= 0.5)).sum()
    assert closings / 10 == pytest.approx(per_minute, rel=0.15)
    assert shut.min() >= 0 and shut.max() <= 1
