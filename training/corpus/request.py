"""Which corpus is wanted, and how BEAT would name its recordings.

``{number}_{name}_0_{start}_{end}``; start and end are numbers of texts, and each emotion has its
own. No two recordings of a speaker have the same pair.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from typing import Final

from motion.clip import check_frame_rate
from motion.errors import InputError
from motion.segment import EMOTIONS
from training.data.beat_names import LAST_TEXTS


def _pairs(emotion: str) -> list[tuple[int, int]]:
    """Return what start and end can be: single texts first, then ever longer runs of them."""
    index = EMOTIONS.index(emotion)
    first, last = (1, *(before + 1 for before in LAST_TEXTS))[index], LAST_TEXTS[index]
    return [
        (start, start + longer)
        for longer in range(last - first + 1)
        for start in range(first, last + 1 - longer)
    ]


MOST_RECORDINGS: Final = min(len(_pairs(emotion)) for emotion in EMOTIONS)
"""Of one speaker in one emotion."""


def recording_name(speaker_number: int, speaker_name: str, emotion: str, index: int) -> str:
    """Return the name of a speaker's recording `index`, from 0, in an emotion.

    Parameters
    ----------
    speaker_number : int
        From 1.
    speaker_name : str
        Letters.
    emotion : str
        One of `motion.segment.EMOTIONS`.
    index : int
        Below `MOST_RECORDINGS`.
    """
    start, end = next(islice(_pairs(emotion), index, None))
    return f"{speaker_number}_{speaker_name}_0_{start}_{end}"


MOST_SPEAKERS: Final = 9999
"""As many as BEAT's names can number."""


_LEAST_SHARED: Final = 4
"""Passages of an emotion that all speak: one for testing, one for validation, and two to tell
apart."""


@dataclass(frozen=True, kw_only=True)
class CorpusRequest:
    """What to make.

    Attributes
    ----------
    speakers : int
        How many speakers, those held out among them.
    sentences : int
        Passages that each speaker speaks, a multiple of eight: as many in each emotion.
    takes : int
        How often each passage is spoken.
    held_out_speakers : int
        The last speakers, whose takes are all for testing.
    frame_rate : float
        Frames per second of the body's motion.
    seed : int
        Where all random numbers come from, at least 0.
    shared_passages : bool
        Whether all speakers speak the same passages, as BEAT's do, rather than passages of their
        own.

    Raises
    ------
    InputError
        If a number is out of range.
    """

    speakers: int = 8
    sentences: int = 16
    takes: int = 2
    held_out_speakers: int = 2
    frame_rate: float = 30.0
    seed: int = 1
    shared_passages: bool = False

    def __post_init__(self) -> None:
        if not 1 <= self.speakers <= MOST_SPEAKERS:
            raise InputError(
                f"{self.speakers} speakers cannot be made", remedy=f"Give 1 to {MOST_SPEAKERS}"
            )
        if not 0 <= self.held_out_speakers < self.speakers:
            raise InputError(
                f"{self.held_out_speakers} of {self.speakers} speakers cannot be held out",
                remedy="Leave at least one to train on",
            )
        if self.sentences < 1 or self.sentences % len(EMOTIONS):
            raise InputError(
                f"{self.sentences} sentences are not as many in each of eight emotions",
                remedy="Give a multiple of eight",
            )
        if self.shared_passages and self.passages < _LEAST_SHARED:
            raise InputError(
                f"of {self.sentences} shared sentences, too few are left to learn from",
                remedy=f"Give at least {_LEAST_SHARED * len(EMOTIONS)}",
            )
        if self.takes < 1 or self.passages * self.takes > MOST_RECORDINGS:
            raise InputError(
                f"{self.passages} sentences an emotion in {self.takes} takes cannot be named as "
                "BEAT names its recordings",
                remedy=f"Make them {MOST_RECORDINGS} together at most, and ask for more speakers",
            )
        if self.seed < 0:
            raise InputError(f"seed {self.seed} is not usable", remedy="Give 0 or more")
        check_frame_rate(self.frame_rate)

    @property
    def passages(self) -> int:
        """Passages of each emotion that a speaker speaks."""
        return self.sentences // len(EMOTIONS)
