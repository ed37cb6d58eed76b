"""The mouth takes the shapes of vowels."""

from __future__ import annotations

import numpy as np

from generators.rule_based.face_motion import speaking_mouth
from motion.audio import Audio
from motion.prosody import prosody

RATE = 16000
FRAME_RATE = 30


def vowel(formants: tuple[float, float], seconds: float = 1.0) -> np.ndarray:
    """A buzz at 120 Hz whose harmonics near the formants are strong."""
    times = np.arange(round(seconds * RATE)) / RATE
    wave = np.zeros_like(times)
    for k in range(1, 30):
        gain = sum(np.exp(-(((120 * k - formant) / 150) ** 2)) for formant in formants)
        wave += (0.02 + gain) * np.sin(2 * np.pi * 120 * k * times)
    return 0.1 * wave


def test_vowels_shape_the_lips() -> None:
    vowels = [vowel((750, 1100)), vowel((300, 2200)), vowel((320, 650))]
    audio = Audio(np.concatenate(vowels).astype(np.float32), RATE)
    speech = prosody(audio, FRAME_RATE)
    shapes = speaking_mouth(audio, speech, np.arange(len(speech.energy)) / FRAME_RATE, 1.0)
    open_vowel, spread, rounded = slice(8, 22), slice(38, 52), slice(68, 82)
    assert shapes["jawOpen"][open_vowel].mean() > 1.5 * shapes["jawOpen"][spread].mean()
    assert shapes["mouthStretch"][spread].mean() > 2 * shapes["mouthStretch"][rounded].mean()
    assert shapes["mouthPucker"][rounded].mean() > 2 * shapes["mouthPucker"][spread].mean()
