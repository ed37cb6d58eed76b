"""The face: what the emotion shows, brows on accents, blinks, gaze and the speaking mouth."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.rule_based.emotion_style import EmotionStyle
from generators.rule_based.gaze import blinks, gaze
from generators.rule_based.minimum_jerk import pulse
from generators.rule_based.mouth import speaking_mouth
from generators.rule_based.smooth_noise import smooth_noise
from motion.audio import Audio
from motion.face import ARKIT_NAMES
from motion.speech.prosody import Prosody

FloatArray = NDArray[np.float64]

_BROW_LEAD: Final = 0.06
_WAVERING: Final = 0.12
_QUIETED_BY_SPEECH: Final = 0.3
_LIP_SHAPES: Final = ("mouthSmile", "mouthFrown", "mouthPress", "mouthShrug", "mouthDimple")


def move_face(
    style: EmotionStyle,
    audio: Audio,
    prosody: Prosody,
    head_in_world: FloatArray,
    times: FloatArray,
    rng: np.random.Generator,
) -> FloatArray:
    """Return the face's movement.

    Parameters
    ----------
    style : EmotionStyle
    audio, prosody : Audio, Prosody
        What is heard.
    head_in_world : ndarray, shape (T, 3)
        Turn of the head in degrees; the eyes make up for it.
    times : ndarray, shape (T,)
        Seconds.
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (T, 52)
        ARKit weights in [0, 1].
    """
    arkit = np.zeros((len(times), len(ARKIT_NAMES)))
    mouth = speaking_mouth(audio, prosody, times, style.face.mouth_opening)
    wavering = 1 + _WAVERING * smooth_noise(times, 1, 0.1, 0.7, rng)[:, 0]
    talking = 1 - _QUIETED_BY_SPEECH * np.clip(mouth["jawOpen"] / 0.3, 0, 1)
    for name, weight in style.face.steady.items():
        held = weight * wavering * (talking if name.startswith(_LIP_SHAPES) else 1.0)
        _add(arkit, name, held)
    accents = _accent_pulses(prosody, times)
    for name, weight in style.face.on_accent.items():
        _add(arkit, name, weight * accents)
    for name, course in mouth.items():
        _add(arkit, name, course)
    for name, course in gaze(head_in_world, style.liveliness.looks_away, times, rng).items():
        _add(arkit, name, course)
    shut = blinks(style.liveliness.blinks, times, rng)
    for name in _sides("eyeBlink"):
        column = arkit[:, ARKIT_NAMES.index(name)]
        column[:] = np.maximum(column, shut)
    for name in _sides("eyeWide"):
        arkit[:, ARKIT_NAMES.index(name)] *= 1 - shut
    clipped: FloatArray = np.clip(arkit, 0, 1)
    return clipped


def _accent_pulses(prosody: Prosody, times: FloatArray) -> FloatArray:
    """Return 1 at the strongest accent; brows lead the voice a little (Flecha-Garcia 2010)."""
    raised = np.zeros(len(times))
    for accent, strength in zip(prosody.accents, prosody.prominence, strict=True):
        hump = pulse(times, accent - _BROW_LEAD, 0.18, 0.45)
        raised = np.maximum(raised, strength * hump)
    return raised


def _sides(name: str) -> tuple[str, ...]:
    """Return the ARKit actions that `name` means: itself, or its left and right one."""
    return (name,) if name in ARKIT_NAMES else (f"{name}Left", f"{name}Right")


def _add(arkit: FloatArray, name: str, course: FloatArray) -> None:
    for action in _sides(name):
        arkit[:, ARKIT_NAMES.index(action)] += course
