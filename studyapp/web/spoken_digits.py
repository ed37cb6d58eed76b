"""The sound of the sound check: recorded digits, joined so that only listening tells them."""

from __future__ import annotations

import io
import wave
from functools import cache
from pathlib import Path
from typing import Final

from studyapp.definition.page import Language

RECORDINGS: Final = Path(__file__).parent / "digit_recordings"
RATE: Final = 16_000
"""Samples a second of every recording; each is mono, of 16 bits."""

SAMPLE_BYTES: Final = 2
BEFORE_SECONDS: Final = 0.5
"""Silence in which loudspeakers that sleep wake up."""

BETWEEN_SECONDS: Final = 0.4


def spoken(language: Language, digits: str) -> bytes:
    """Return a WAV file in which `digits` are read out.

    Each digit takes the same time, so that files of as many digits have the same size.
    """
    recordings = _recordings(language)
    slot = max(len(recording) for recording in recordings) + _silence(BETWEEN_SECONDS)
    sound = b"".join(recordings[int(digit)].ljust(slot, b"\0") for digit in digits)
    file = io.BytesIO()
    with wave.open(file, "wb") as joined:
        joined.setnchannels(1)
        joined.setsampwidth(SAMPLE_BYTES)
        joined.setframerate(RATE)
        joined.writeframes(b"\0" * _silence(BEFORE_SECONDS) + sound)
    return file.getvalue()


def _silence(seconds: float) -> int:
    """Return how many bytes `seconds` take."""
    return SAMPLE_BYTES * round(seconds * RATE)


@cache
def _recordings(language: Language) -> tuple[bytes, ...]:
    """Return the samples of each digit, 0 first."""
    samples = []
    for digit in range(10):
        with wave.open(str(RECORDINGS / language / f"{digit}.wav"), "rb") as recording:
            samples.append(recording.readframes(recording.getnframes()))
    return tuple(samples)
