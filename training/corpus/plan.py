"""The takes of a corpus and their splits.

Every speaker has their own passages, unless all speak the same ones. With p the number of a speaker
plus that of an emotion, counted from 0 in the order of `motion.segment.EMOTIONS`:

======= ==================================================================================
p mod 4 what is kept from training
======= ==================================================================================
0       the last passage, made of sentences that are spoken nowhere else: all takes for testing
1       the last take of the first passage, for testing; nothing where it is the only one
2       the last take of the first passage, for validation
3       nothing
======= ==================================================================================

If all speak the same passages, the last sixth of each emotion's, at least one, is for testing, made
of sentences that occur nowhere else; the same number before it is for validation.

All takes of held-out speakers are for testing; every other passage is unheard, or those that are
unheard for all.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from motion.segment import EMOTIONS
from training.corpus.request import CorpusRequest, recording_name
from training.corpus.speakers import CorpusSpeaker, read_table, speaker_of

SENTENCES: Final[Mapping[str, Mapping[str, Sequence[str]]]] = read_table("sentences.toml")
"""Of each emotion, ``openings`` and ``closings``: what speakers say is one of each."""

Split = Literal["train", "validation", "test"]

RESERVED_SENTENCES: Final = 3
"""Openings, and closings, of each emotion that occur only in test passages."""


@dataclass(frozen=True, kw_only=True)
class PlannedTake:
    """One recording of the corpus.

    Attributes
    ----------
    name : str
        As BEAT names recordings.
    speaker : CorpusSpeaker
        The speaker.
    emotion : str
        One of `motion.segment.EMOTIONS`.
    text : str
        The text.
    take : int
        Number of the take, from 1.
    split : {'train', 'validation', 'test'}
        Its split.
    unheard : bool
        Whether its sentences occur in no take for training or validation.
    held_out_speaker : bool
        Whether its speaker occurs in no take for training or validation.
    seed : tuple of int
        Of its random numbers.
    """

    name: str
    speaker: CorpusSpeaker
    emotion: str
    text: str
    take: int
    split: Split
    unheard: bool
    held_out_speaker: bool
    seed: tuple[int, ...]

    @property
    def folder(self) -> str:
        """Its folder in the corpus: BEAT has one for each speaker."""
        return str(self.speaker.number)


def planned_takes(request: CorpusRequest) -> Iterator[PlannedTake]:
    """Yield the takes of a corpus, speaker by speaker and emotion by emotion."""
    for number in range(1, request.speakers + 1):
        speaker = speaker_of(number, request.seed)
        held_out = number > request.speakers - request.held_out_speakers
        for emotion in EMOTIONS:
            for index in range(request.passages * request.takes):
                place, take = divmod(index, request.takes)
                yield _take(request, speaker, emotion, place, take, held_out)


def _take(
    request: CorpusRequest,
    speaker: CorpusSpeaker,
    emotion: str,
    place: int,
    take: int,
    held_out: bool,
) -> PlannedTake:
    pattern = (speaker.number + EMOTIONS.index(emotion)) % 4
    last_passage, last_take = place == request.passages - 1, take == request.takes - 1
    split: Split = "train"
    if request.shared_passages:
        reserved = max(1, request.passages // 6)
        unheard = place >= request.passages - reserved
        if place >= request.passages - 2 * reserved:
            split = "validation"
    elif held_out:
        unheard = (pattern + place) % 2 == 0
    else:
        unheard = pattern == 0 and last_passage
        if place == 0 and last_take:
            single = request.passages * request.takes == 1
            split = (
                "validation" if pattern == 2 else "test" if pattern == 1 and not single else "train"
            )
    if held_out or unheard:
        split = "test"
    first_passage = 0 if request.shared_passages else (speaker.number - 1) * request.passages
    name = recording_name(speaker.number, speaker.name, emotion, place * request.takes + take)
    return PlannedTake(
        name=name,
        speaker=speaker,
        emotion=emotion,
        text=passage(emotion, first_passage + place, unheard=unheard),
        take=take + 1,
        split=split,
        unheard=unheard,
        held_out_speaker=held_out,
        seed=(request.seed, zlib.crc32(name.encode())),
    )


def passage(emotion: str, number: int, *, unheard: bool = False) -> str:
    """Return a passage of two sentences.

    Parameters
    ----------
    emotion : str
        One of `motion.segment.EMOTIONS`.
    number : int
        Which one, from 0. Passages repeat when openings have met all closings: after 81, or 9
        where `unheard`. The first 9, or 3, share no sentence.
    unheard : bool
        Whether it consists of the sentences reserved for testing.

    Returns
    -------
    str
        Twenty words or so, spoken in six to nine seconds.
    """
    openings, closings = (
        sentences[-RESERVED_SENTENCES:] if unheard else sentences[:-RESERVED_SENTENCES]
        for sentences in (SENTENCES[emotion]["openings"], SENTENCES[emotion]["closings"])
    )
    count = len(openings)
    opening, shift = number % count, number // count % count
    return f"{openings[opening]} {closings[(opening + shift) % count]}"
