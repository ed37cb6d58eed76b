"""Record the digits of the sound check with espeak-ng, in every language of the pages.

Usage: python -m tools.spoken_digits. It writes the files studyapp/web/digit_recordings/*/*.wav: 16
kHz, mono, without silence at the ends, at the loudness of the videos.
"""

import io
import subprocess
from pathlib import Path

import numpy as np
import pyloudnorm
import soundfile
from numpy.typing import NDArray
from scipy.signal import resample_poly

HERE = Path(__file__).resolve().parents[1] / "studyapp" / "web" / "digit_recordings"
RATE = 16_000
LOUDNESS = -23.0
"""LUFS, the loudness of all videos."""

QUIET = 0.01
"""Share of the peak below which samples at the ends are cut off."""

EDGE_SECONDS = 0.02
WORDS_PER_MINUTE = 130

VOICES = {"en": "en-gb", "de": "de", "ja": "ja"}
WORDS = {
    "en": ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine"),
    "de": ("null", "eins", "zwei", "drei", "vier", "fünf", "sechs", "sieben", "acht", "neun"),
    "ja": ("ゼロ", "いち", "に", "さん", "よん", "ご", "ろく", "なな", "はち", "きゅう"),
}


def spoken(voice: str, word: str) -> NDArray[np.float64]:
    """Return `word` spoken by `voice`, at `RATE`."""
    command = ["espeak-ng", "-v", voice, "-s", str(WORDS_PER_MINUTE), "--stdout", word]
    audio = subprocess.run(command, check=True, capture_output=True).stdout
    samples, rate = soundfile.read(io.BytesIO(audio))
    return np.asarray(resample_poly(samples, RATE, rate))


def cut_close(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `samples` without silence at the ends, faded in and out."""
    loud = np.flatnonzero(np.abs(samples) > QUIET * np.abs(samples).max())
    edge = round(EDGE_SECONDS * RATE)
    trimmed = samples[max(0, loud[0] - edge) : loud[-1] + edge].copy()
    ramp = np.linspace(0, 1, edge)
    trimmed[:edge] *= ramp
    trimmed[-edge:] *= ramp[::-1]
    return trimmed


def levelled(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `samples` at `LOUDNESS`; one digit is too short to measure, so it is repeated."""
    measured: float = pyloudnorm.Meter(RATE).integrated_loudness(np.tile(samples, 8))
    return samples * 10 ** ((LOUDNESS - measured) / 20)


if __name__ == "__main__":
    for language, words in WORDS.items():
        folder = HERE / language
        folder.mkdir(parents=True, exist_ok=True)
        for digit, word in enumerate(words):
            samples = levelled(cut_close(spoken(VOICES[language], word)))
            soundfile.write(folder / f"{digit}.wav", samples, RATE, subtype="PCM_16")
            print(f"{language} {digit}: {len(samples) / RATE:.2f} s, peak {abs(samples).max():.2f}")
