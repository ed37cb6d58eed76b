"""The voices of the corpus, and how a take is spoken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from motion.speech.synthesis import PROSODY_OF_EMOTION, SpokenProsody


@dataclass(frozen=True, kw_only=True)
class Voice:
    """A voice of espeak-ng.

    Attributes
    ----------
    name : str
        espeak-ng's name of it.
    loudness : float
        Factor on the amplitude, so that all voices are about equally loud.
    pitch : float
        Its median fundamental frequency in Hz where it speaks neutrally, as measured.
    """

    name: str
    loudness: float
    pitch: float


VOICES: Final = (
    Voice(name="en-us+m3", loudness=1.0, pitch=101),
    Voice(name="en-us+f2", loudness=0.85, pitch=185),
    Voice(name="en-gb", loudness=0.95, pitch=97),
    Voice(name="en-gb-x-rp+f1", loudness=0.8, pitch=170),
    Voice(name="en-us+m7", loudness=0.85, pitch=101),
    Voice(name="en-us+belinda", loudness=0.75, pitch=215),
    Voice(name="en-us+quincy", loudness=1.2, pitch=81),
    Voice(name="en-us+shelby", loudness=0.9, pitch=176),
    Voice(name="en-us+grandpa", loudness=1.0, pitch=108),
    Voice(name="en-gb-scotland+f2", loudness=0.7, pitch=185),
    Voice(name="en-us+edward", loudness=0.75, pitch=96),
    Voice(name="en-us+Annie", loudness=0.95, pitch=237),
    Voice(name="en-us+Alex", loudness=1.2, pitch=97),
    Voice(name="en-us+f4", loudness=0.85, pitch=170),
    Voice(name="en-029", loudness=0.9, pitch=97),
    Voice(name="en-us+linda", loudness=0.8, pitch=215),
)
"""Alternately low and high; they differ in timbre, accent and height."""

_PITCH_OF_LAPS: Final = (0, 8, -8, 14, -14)
"""How much higher the voice is spoken when all voices have been used once, twice, …"""

_SPEED_BETWEEN_TAKES: Final = 0.05
_PITCH_BETWEEN_TAKES: Final = 4
_AMPLITUDE_BETWEEN_TAKES: Final = 0.06


def voice_of(number: int) -> Voice:
    """Return the voice of the speaker with this number, from 1."""
    return VOICES[(number - 1) % len(VOICES)]


def spoken_prosody(emotion: str, number: int, random: np.random.Generator) -> SpokenProsody:
    """Return how a speaker speaks one take.

    Parameters
    ----------
    emotion : str
        One of `motion.segment.EMOTIONS`.
    number : int
        The speaker's, from 1.
    random : numpy Generator
        Of the take: no two takes are spoken quite alike (speed within 5 %, loudness within 6 %,
        pitch within 4 of espeak-ng's steps).
    """
    usual = PROSODY_OF_EMOTION[emotion]
    lap = _PITCH_OF_LAPS[(number - 1) // len(VOICES) % len(_PITCH_OF_LAPS)]
    speed, loudness = random.uniform(-1, 1, 2)
    pitch = usual.pitch + lap + random.integers(-_PITCH_BETWEEN_TAKES, _PITCH_BETWEEN_TAKES + 1)
    amplitude = usual.amplitude * voice_of(number).loudness
    return SpokenProsody(
        speed=round(usual.speed * (1 + _SPEED_BETWEEN_TAKES * speed)),
        pitch=int(np.clip(pitch, 0, 99)),
        pitch_range=usual.pitch_range,
        amplitude=round(amplitude * (1 + _AMPLITUDE_BETWEEN_TAKES * loudness)),
    )
