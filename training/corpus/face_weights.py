"""Facial motion of the corpus' speakers: 51 ARKit weights over time.

A weight is what the emotion gives it, then as much of the rest as the speech takes: ``base + (1 -
base) * speech``. Mouth and jaw follow loudness and brightness, brows the melody.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from training.corpus.chance import Chance
from training.corpus.speakers import EMOTION_MOTION, CorpusSpeaker
from training.corpus.speech_curves import SpeechCurves
from training.spaces.beat import FACIAL_WEIGHTS

FloatArray = NDArray[np.float64]

_AT_REST: Final = 0.03
_OPEN: Final = 0.42
_ROUND: Final = 0.4
_WIDE: Final = 0.5
_LIPS_DOWN: Final = 0.4
_LIPS_UP: Final = 0.2
_BROWS: Final = 0.8
_LOWERED: Final = 0.5
_WANDERING: Final = 0.05
_GAZE: Final = 0.14
_BLINK: Final = 0.12
"""Seconds in which lids close, and open again."""

_FACE_STREAM, _GAZE_STREAM = 4, 5


def face_weights(
    curves: SpeechCurves,
    melody: FloatArray,
    emotion: str,
    speaker: CorpusSpeaker,
    chance: Chance,
    times: FloatArray,
) -> FloatArray:
    """Return facial weights, shape (T, 51) in [0, 1], in ARKit's order.

    The parameters are those of `training.corpus.body_angles.body_angles`.
    """
    expressiveness = speaker.expressiveness
    base = _AT_REST + np.zeros(len(FACIAL_WEIGHTS))
    for name, weight in EMOTION_MOTION[emotion].face.items():
        sides = [name] if name in FACIAL_WEIGHTS else [f"{name}Left", f"{name}Right"]
        base[[FACIAL_WEIGHTS.index(side) for side in sides]] += expressiveness * weight
    speech_weights = _speech(curves, melody, times)
    weights = np.tile(base, (len(times), 1))
    for name, share in speech_weights.items():
        column = FACIAL_WEIGHTS.index(name)
        weights[:, column] += (1 - base[column]) * expressiveness * share
    weights *= 1 + _WANDERING * chance.drift(times, len(FACIAL_WEIGHTS), _FACE_STREAM)
    for name, share in (_gaze(chance, times) | _blinks(chance, times)).items():
        weights[:, FACIAL_WEIGHTS.index(name)] += share
    return np.asarray(np.clip(weights, 0, 1))


def _speech(curves: SpeechCurves, melody: FloatArray, times: FloatArray) -> dict[str, FloatArray]:
    """Return the contribution of speech to each weight, for average faces."""
    loudness = np.minimum(curves.at(curves.loudness, times), 1.5)
    brightness = curves.at(curves.brightness, times)
    darkness = 1 - brightness
    raised = _BROWS * np.maximum(melody, 0)
    lowered = _LOWERED * np.maximum(-melody, 0)
    paired = {
        "mouthLowerDown": _LIPS_DOWN * loudness,
        "mouthUpperUp": _LIPS_UP * loudness,
        "mouthStretch": _WIDE * loudness * brightness,
        "browOuterUp": raised,
        "browDown": lowered,
    }
    return {
        "jawOpen": _OPEN * loudness * (0.5 + 0.5 * darkness),
        "mouthFunnel": _ROUND * loudness * darkness,
        "mouthPucker": _ROUND / 2 * loudness * darkness,
        "browInnerUp": raised,
        **{f"{name}{side}": share for name, share in paired.items() for side in ("Left", "Right")},
    }


def _gaze(chance: Chance, times: FloatArray) -> dict[str, FloatArray]:
    """Return the contribution of eye movement, the same for both eyes."""
    sideways, up = _GAZE * chance.drift(times, 2, _GAZE_STREAM).T
    left, right = np.maximum(sideways, 0), np.maximum(-sideways, 0)
    return {
        "eyeLookOutLeft": left,
        "eyeLookInRight": left,
        "eyeLookInLeft": right,
        "eyeLookOutRight": right,
        "eyeLookUpLeft": np.maximum(up, 0),
        "eyeLookUpRight": np.maximum(up, 0),
        "eyeLookDownLeft": np.maximum(-up, 0),
        "eyeLookDownRight": np.maximum(-up, 0),
    }


def _blinks(chance: Chance, times: FloatArray) -> dict[str, FloatArray]:
    """Return the contribution of blinks."""
    moments = chance.blinks(float(times[-1]) if len(times) else 0.0)
    closure = np.zeros(len(times))
    for moment in moments:
        closure = np.maximum(closure, np.clip(1 - np.abs(times - moment) / _BLINK, 0, 1))
    return {"eyeBlinkLeft": closure, "eyeBlinkRight": closure}
