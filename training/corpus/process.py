"""The known process from speech, emotion and speaker to motion, and the part due to speech."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion.arrays import Floats
from motion.audio import Audio
from motion.clip import check_frame_rate
from training.corpus.body_angles import body_angles, joint_rotations
from training.corpus.chance import EXPECTED, Chance
from training.corpus.speakers import EMOTION_MOTION, CorpusSpeaker, voice_of
from training.corpus.speech_curves import SpeechCurves, Strokes, analyse, find_strokes
from training.corpus.truth import MotionCurves, curves_of
from training.spaces.beat import FACIAL_WEIGHTS

VERSION: Final = "4"
"""Incremented whenever the same speech, speaker and random numbers may give other motion."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Process:
    """The causes of one take's motion: speaker, speech and emotion.

    Attributes
    ----------
    curves : SpeechCurves
        The speech.
    duration : float
        Its length in seconds.
    emotion : str
        One of `motion.segment.EMOTIONS`.
    speaker : CorpusSpeaker
        The speaker.
    """

    curves: SpeechCurves
    duration: float
    emotion: str
    speaker: CorpusSpeaker

    @classmethod
    def from_speech(cls, speech: Audio, emotion: str, speaker: CorpusSpeaker) -> Process:
        """Analyse `speech`, mono at 16 kHz."""
        return cls(
            curves=analyse(speech), duration=speech.duration, emotion=emotion, speaker=speaker
        )

    @property
    def strokes(self) -> Strokes:
        """The strokes that the speech prompts."""
        return find_strokes(self.curves, EMOTION_MOTION[self.emotion].spacing)

    def body(self, frame_rate: float, chance: Chance = EXPECTED) -> Floats:
        """Return the body's motion.

        Parameters
        ----------
        frame_rate : float
            Frames per second; frame k is at ``k / frame_rate`` seconds.
        chance : Chance, optional
            The take's random numbers; expected values by default.

        Returns
        -------
        ndarray, shape (T, 141)
            Axis-angle in radians of BEAT's 47 joints, ``T = round(duration * frame_rate)``.
        """
        times = self._times(frame_rate)
        angles = body_angles(
            self.curves, self._melody(times), self.emotion, self.speaker, chance, times
        )
        return joint_rotations(angles)

    def face(self, frame_rate: float, chance: Chance = EXPECTED) -> Floats:
        """Return the face's motion: ARKit weights (T, 51) in [0, 1]; see `body`."""
        times = self._times(frame_rate)
        speech = _speech_weights(self.curves, self._melody(times), times)
        return _face_weights(speech, self.emotion, self.speaker, chance, times)

    def drive(self, frame_rate: float) -> MotionCurves:
        """Return the part of the motion that speech determines.

        It is the process without chance: every random number has its expected value.
        """
        return curves_of(self.body(frame_rate), self.face(frame_rate), frame_rate)

    def _times(self, frame_rate: float) -> Floats:
        check_frame_rate(frame_rate)
        return np.arange(max(1, round(self.duration * frame_rate))) / frame_rate

    def _melody(self, times: Floats) -> Floats:
        """Return the pitch in octaves above the voice's usual pitch, 0 in silence."""
        usual = np.log2(voice_of(self.speaker.number).pitch / 100)
        curves = self.curves
        return np.asarray(
            curves.at(curves.pitch, times) - usual * curves.at(curves.sounding, times)
        )


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
"""Seconds in which lids close, and in which they open again."""

_FACE_STREAM, _GAZE_STREAM = 4, 5


def _face_weights(
    speech_weights: Mapping[str, Floats],
    emotion: str,
    speaker: CorpusSpeaker,
    chance: Chance,
    times: Floats,
) -> Floats:
    """Return facial weights (T, 51) in [0, 1].

    A weight is ``base + (1 - base) * speech``, where the base depends on the emotion. Mouth and jaw
    follow loudness and brightness, brows the melody.
    """
    expressiveness = speaker.expressiveness
    base = _AT_REST + np.zeros(len(FACIAL_WEIGHTS))
    for name, weight in EMOTION_MOTION[emotion].face.items():
        sides = [name] if name in FACIAL_WEIGHTS else [f"{name}Left", f"{name}Right"]
        base[[FACIAL_WEIGHTS.index(side) for side in sides]] += expressiveness * weight
    weights = np.tile(base, (len(times), 1))
    for name, share in speech_weights.items():
        column = FACIAL_WEIGHTS.index(name)
        weights[:, column] += (1 - base[column]) * expressiveness * share
    weights *= 1 + _WANDERING * chance.drift(times, len(FACIAL_WEIGHTS), _FACE_STREAM)
    for name, share in (_gaze(chance, times) | _blinks(chance, times)).items():
        weights[:, FACIAL_WEIGHTS.index(name)] += share
    return np.asarray(np.clip(weights, 0, 1))


def _speech_weights(curves: SpeechCurves, melody: Floats, times: Floats) -> dict[str, Floats]:
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


def _gaze(chance: Chance, times: Floats) -> dict[str, Floats]:
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


def _blinks(chance: Chance, times: Floats) -> dict[str, Floats]:
    """Return the contribution of blinks."""
    closure = np.zeros(len(times))
    for moment in chance.blinks(float(times[-1])):
        closure = np.maximum(closure, np.clip(1 - np.abs(times - moment) / _BLINK, 0, 1))
    return {"eyeBlinkLeft": closure, "eyeBlinkRight": closure}
