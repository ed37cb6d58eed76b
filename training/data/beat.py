"""BEAT and BEAT2 (Liu et al. 2022, 2024): names of recordings, and motion.

The name of a recording is ``{number}_{name}_{type}_{start}_{end}``: number and name of the speaker,
the type of recording (even: monologue; odd: conversation; 0 and 1: English), and the first and last
text that is spoken.
"""

import re
from dataclasses import dataclass
from typing import Final, Self

from motion.audio import read_audio
from motion.errors import InputError
from motion.formats.bvh import BvhFrameCountError, read_bvh
from motion.formats.bvh_motion import BvhMotion, settle_first_frame
from motion.segment import EMOTIONS
from training.data.take import LONGEST_DIFFERENCE, Split, Take


def read_beat_bvh(take: Take) -> BvhMotion:
    """Return the motion of a take, without a leftover calibration pose in its first row.

    If the header declares another number of frames than the file has, as in downsampled files, the
    frame rate is the header's or the one that keeps the header's duration, whichever matches the
    sound.

    Raises
    ------
    InputError
        If the file is not a BVH or is damaged, or neither frame rate fits the sound.
    """
    try:
        motion = read_bvh(take.motion)
    except BvhFrameCountError as error:
        seconds = read_audio(take.speech).duration
        fitting = [
            rate
            for rate in error.frame_rates
            if abs(error.rows / rate - seconds) <= LONGEST_DIFFERENCE
        ]
        if not fitting:
            raise InputError(
                f"{error.what}, while the sound lasts {seconds:.2f} s",
                where=take.motion,
                remedy="Copy the motion again, or correct its header",
            ) from error
        motion = read_bvh(take.motion, frame_rate=fitting[0])
    return settle_first_frame(motion)


_NAME: Final = re.compile(
    r"(?P<number>\d{1,4})_(?P<speaker>[A-Za-z][A-Za-z0-9-]*)_(?P<type>\d)_"
    r"(?P<start>\d{1,5})_(?P<end>\d{1,5})"
)

LAST_TEXTS: Final = (64, 72, 80, 86, 94, 102, 110, 118)
"""The last text of a monologue in each of `motion.segment.EMOTIONS`."""

_FOUR_HOUR_SPEAKERS: Final = frozenset({1, 2, 3, 4, 6, 7, 8, 9, 11, 21})
"""Speakers with four hours of recordings; the other twenty have one."""

_SPEAKERS: Final = 30
_FIRST_OF_EMOTION: Final = frozenset(last + 1 for last in LAST_TEXTS[:-1])
_LAST_OF_EMOTION: Final = frozenset(LAST_TEXTS[1:])


@dataclass(frozen=True, kw_only=True)
class BeatName:
    """The parts of a recording's name.

    Attributes
    ----------
    number : int
        Number of the speaker, from 1.
    speaker : str
        Name of the speaker.
    recording_type : int
        Type of the recording, 0 to 7; see the module.
    start, end : int
        Numbers of the first and last text.
    """

    number: int
    speaker: str
    recording_type: int
    start: int
    end: int

    @classmethod
    def parse(cls, name: str) -> Self | None:
        """Return the parts of `name`; None if it is not a name of BEAT."""
        match = _NAME.fullmatch(name)
        if match is None:
            return None
        return cls(
            number=int(match["number"]),
            speaker=match["speaker"],
            recording_type=int(match["type"]),
            start=int(match["start"]),
            end=int(match["end"]),
        )

    @property
    def emotion(self) -> str:
        """The emotion of a monologue; empty for conversations and for several emotions."""
        if self.recording_type % 2:
            return ""
        first, last = (_emotion_of(text) for text in (self.start, self.end))
        return first if first == last else ""

    @property
    def published_split(self) -> Split | None:
        """The split of an English recording of a single text, by the rule published with BEAT.

        For the twenty speakers with one hour, the rule cuts some recordings into a validation half
        and a test half. Here the whole recording is for testing, so that no recording is in two
        splits. None for recordings that the rule does not cover.
        """
        if self.recording_type > 1 or self.start != self.end or not 1 <= self.number <= _SPEAKERS:
            return None
        four_hours = self.number in _FOUR_HOUR_SPEAKERS
        if self.recording_type == 1:
            if self.start == 1:
                return "test"
            return "validation" if four_hours and self.start == 12 else "train"
        if not 1 <= self.start <= LAST_TEXTS[-1]:
            return None
        if self.start <= 8:
            return "test" if four_hours or self.start <= 4 else "validation"
        if self.start in _FIRST_OF_EMOTION:
            return "test"
        if four_hours and (57 <= self.start <= 64 or self.start in _LAST_OF_EMOTION):
            return "validation"
        return "train"


def _emotion_of(text: int) -> str:
    last_texts = zip(LAST_TEXTS, EMOTIONS, strict=True)
    return next((emotion for last_text, emotion in last_texts if text <= last_text), "")
