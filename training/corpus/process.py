"""The known process: from speech, emotion and speaker to motion, and what of it speech decides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.audio import Audio
from motion.clip import check_frame_rate
from motion.errors import InputError
from training.corpus.body_angles import body_angles, joint_rotations
from training.corpus.chance import EXPECTED, Chance
from training.corpus.face_weights import face_weights
from training.corpus.motion_curves import MotionCurves, curves_of
from training.corpus.speakers import EMOTION_MOTION, CorpusSpeaker, voice_of
from training.corpus.speech_curves import SpeechCurves, Strokes, analyse, find_strokes

FloatArray = NDArray[np.float64]

VERSION: Final = "4"
"""Changes whenever the same speech, speaker and random numbers may give other motion."""


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
        """Hear `speech`, mono at 16 kHz.

        Raises
        ------
        InputError
            If the speech is not at 16 kHz or too short, or the emotion is unknown.
        """
        if emotion not in EMOTION_MOTION:
            raise InputError(
                f"unknown emotion {emotion!r}", remedy=f"Use one of {', '.join(EMOTION_MOTION)}"
            )
        return cls(
            curves=analyse(speech), duration=speech.duration, emotion=emotion, speaker=speaker
        )

    @property
    def strokes(self) -> Strokes:
        """The strokes that the speech calls for."""
        return find_strokes(self.curves, EMOTION_MOTION[self.emotion].spacing)

    def body(self, frame_rate: float, chance: Chance = EXPECTED) -> FloatArray:
        """Return the body's motion.

        Parameters
        ----------
        frame_rate : float
            Frames per second; frame k lies at ``k / frame_rate`` seconds.
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

    def face(self, frame_rate: float, chance: Chance = EXPECTED) -> FloatArray:
        """Return the face's motion: ARKit weights (T, 51) in [0, 1]; see `body`."""
        times = self._times(frame_rate)
        return face_weights(
            self.curves, self._melody(times), self.emotion, self.speaker, chance, times
        )

    def drive(self, frame_rate: float) -> MotionCurves:
        """Return the motion without chance; see the function `drive`."""
        return curves_of(self.body(frame_rate), self.face(frame_rate), frame_rate)

    def _times(self, frame_rate: float) -> FloatArray:
        check_frame_rate(frame_rate)
        return np.arange(max(1, round(self.duration * frame_rate))) / frame_rate

    def _melody(self, times: FloatArray) -> FloatArray:
        """Return the pitch in octaves above what is usual for the voice, 0 in silence."""
        usual = np.log2(voice_of(self.speaker.number).pitch / 100)
        curves = self.curves
        return np.asarray(
            curves.at(curves.pitch, times) - usual * curves.at(curves.sounding, times)
        )


def drive(speech: Audio, emotion: str, speaker: CorpusSpeaker, frame_rate: float) -> MotionCurves:
    """Return the part of the motion that speech determines.

    It is the process without chance: every random number has its expected value.

    Parameters
    ----------
    speech : Audio
        Mono, 16 kHz, as `motion.audio.read_audio` reads it.
    emotion : str
        One of `motion.segment.EMOTIONS`.
    speaker : CorpusSpeaker
        The speaker; `training.corpus.speakers.speaker_of` gives those of a corpus.
    frame_rate : float
        Frames per second of the curves.

    Returns
    -------
    MotionCurves
        The same curves that `training.corpus.motion_curves.curves_of` finds in any motion.

    Raises
    ------
    InputError
        If the speech is not at 16 kHz or too short, or emotion or frame rate are not usable.
    """
    return Process.from_speech(speech, emotion, speaker).drive(frame_rate)
