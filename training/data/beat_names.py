"""What the names of BEAT's recordings tell: who speaks, with which emotion, and for what it is.

Liu et al. 2022. A name is ``{number}_{name}_{type}_{start}_{end}``: number and name of the speaker,
the type of recording (even: somebody speaks alone; odd: conversation; 0 and 1: English), and the
first and last of the texts that are spoken.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final, Self

from motion.segment import EMOTIONS
from training.data.take import Split

_NAME: Final = re.compile(
    r"(?P<number>\d{1,4})_(?P<speaker>[A-Za-z][A-Za-z0-9-]*)_(?P<type>\d)_"
    r"(?P<start>\d{1,5})_(?P<end>\d{1,5})"
)

LAST_TEXTS: Final = (64, 72, 80, 86, 94, 102, 110, 118)
"""Up to which text somebody who speaks alone does so with each of `motion.segment.EMOTIONS`."""

_FOUR_HOURS: Final = frozenset({1, 2, 3, 4, 6, 7, 8, 9, 11, 21})
"""Speakers of whom there are four hours; of the other twenty there is one."""

_SPEAKERS: Final = 30
_FIRST_OF_EMOTION: Final = frozenset(last + 1 for last in LAST_TEXTS[:-1])
_LAST_OF_EMOTION: Final = frozenset(LAST_TEXTS[1:])


@dataclass(frozen=True, kw_only=True)
class BeatName:
    """What a name tells.

    Attributes
    ----------
    number : int
        Of the speaker, from 1.
    speaker : str
        Their name.
    recording_type : int
        0 to 7, see above.
    start, end : int
        First and last text.
    """

    number: int
    speaker: str
    recording_type: int
    start: int
    end: int

    @classmethod
    def parse(cls, name: str) -> Self | None:
        """Return what `name` tells; None where BEAT names nothing like that."""
        found = _NAME.fullmatch(name)
        if found is None:
            return None
        return cls(
            number=int(found["number"]),
            speaker=found["speaker"],
            recording_type=int(found["type"]),
            start=int(found["start"]),
            end=int(found["end"]),
        )

    @property
    def emotion(self) -> str:
        """The emotion of somebody who speaks alone; empty for conversations and other texts.

        Texts with several emotions have none either.
        """
        if self.recording_type % 2:
            return ""
        first, last = (_emotion_of(text) for text in (self.start, self.end))
        return first if first == last else ""

    @property
    def published_split(self) -> Split | None:
        """The split of an English recording of a single text, by the rule published with BEAT.

        Of the twenty speakers of one hour, the rule cuts recordings in two, half for validation
        and half for testing; here they are for testing as a whole, so that no recording is in two
        splits. None where the rule says nothing.
        """
        if self.recording_type > 1 or self.start != self.end or not 1 <= self.number <= _SPEAKERS:
            return None
        long = self.number in _FOUR_HOURS
        if self.recording_type == 1:
            if self.start == 1:
                return "test"
            return "validation" if long and self.start == 12 else "train"
        if not 1 <= self.start <= LAST_TEXTS[-1]:
            return None
        if self.start <= 8:
            return "test" if long or self.start <= 4 else "validation"
        if self.start in _FIRST_OF_EMOTION:
            return "test"
        if long and (57 <= self.start <= 64 or self.start in _LAST_OF_EMOTION):
            return "validation"
        return "train"


def _emotion_of(text: int) -> str:
    lasts = zip(LAST_TEXTS, EMOTIONS, strict=True)
    return next((emotion for last, emotion in lasts if text <= last), "")
