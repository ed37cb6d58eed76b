"""The request of a corpus, recorded in its ``corpus.json``, and the planned takes and their splits.

Every speaker has their own passages, unless passages are shared. Let p be the number of a speaker
plus that of an emotion, counted from 0 in the order of `motion.segment.EMOTIONS`:

======= ==================================================================================
p mod 4 held out from training
======= ==================================================================================
0       all takes of the last passage, of sentences that occur nowhere else, for testing
1       the last take of the first passage, for testing; nothing if it is the only take
2       the last take of the first passage, for validation
3       nothing
======= ==================================================================================

If passages are shared, the last sixth of each emotion's passages, at least one, is for testing.
Their sentences occur nowhere else. The same number of passages before them is for validation.

All takes of held-out speakers are for testing. Every second of their passages is unheard; if
passages are shared, the unheard ones are those of all speakers.

Recordings are named as in BEAT, ``{number}_{name}_0_{start}_{end}``: start and end are numbers of
texts, and each emotion has its own. No two recordings of a speaker have the same pair.
"""

import json
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

from motion.errors import InputError
from motion.files import write_text
from motion.segment import EMOTIONS
from motion.synthesis import synthesiser_version
from training.corpus.process import VERSION
from training.corpus.speakers import CorpusSpeaker, read_table, speaker_of
from training.data.beat import LAST_TEXTS
from training.data.take import Split


def _text_ranges(emotion: str) -> list[tuple[int, int]]:
    """Return possible starts and ends: single texts first, then ever longer ranges."""
    index = EMOTIONS.index(emotion)
    first, last = (1, *(text + 1 for text in LAST_TEXTS))[index], LAST_TEXTS[index]
    return [
        (start, start + extra)
        for extra in range(last - first + 1)
        for start in range(first, last + 1 - extra)
    ]


MOST_RECORDINGS: Final = min(len(_text_ranges(emotion)) for emotion in EMOTIONS)
"""Largest number of recordings of one speaker in one emotion."""

_LEAST_SHARED: Final = 4
"""Fewest shared passages of an emotion: one for testing, one for validation, and two to compare."""


@dataclass(frozen=True, kw_only=True)
class CorpusRequest:
    """The request of a corpus.

    Attributes
    ----------
    speakers : int
        Number of speakers, including held-out ones.
    sentences : int
        Number of passages of each speaker, a multiple of eight: equally many in each emotion.
    takes : int
        Number of takes of each passage.
    held_out_speakers : int
        Number of speakers, the last ones, whose takes are all for testing.
    frame_rate : float
        Frames per second of the body's motion.
    seed : int
        Seed of all random numbers, at least 0.
    shared_passages : bool
        Whether all speakers speak the same passages, as BEAT's do, rather than their own.

    Raises
    ------
    InputError
        If BEAT's names or the passages do not suffice, or nothing is left to train on.
    """

    speakers: int = 8
    sentences: int = 16
    takes: int = 2
    held_out_speakers: int = 2
    frame_rate: float = 30.0
    seed: int = 1
    shared_passages: bool = False

    def __post_init__(self) -> None:
        if self.held_out_speakers >= self.speakers:
            raise InputError(
                f"{self.held_out_speakers} of {self.speakers} speakers cannot be held out",
                remedy="Leave at least one to train on",
            )
        if self.sentences % len(EMOTIONS):
            raise InputError(
                f"{self.sentences} sentences cannot be divided equally among eight emotions",
                remedy="Give a multiple of eight",
            )
        if self.shared_passages and self.passages < _LEAST_SHARED:
            raise InputError(
                f"{self.sentences} shared sentences leave too few for training",
                remedy=f"Give at least {_LEAST_SHARED * len(EMOTIONS)}",
            )
        if self.passages * self.takes > MOST_RECORDINGS:
            raise InputError(
                f"BEAT's names do not suffice for {self.passages} sentences per emotion in "
                f"{self.takes} takes",
                remedy=f"Ask for at most {MOST_RECORDINGS} recordings per emotion, and for more "
                "speakers",
            )

    @property
    def passages(self) -> int:
        """Number of passages of each speaker in each emotion."""
        return self.sentences // len(EMOTIONS)


SENTENCES: Final[Mapping[str, Mapping[str, Sequence[str]]]] = read_table("sentences.toml")
"""``openings`` and ``closings`` of each emotion: a passage is one of each."""

RESERVED_SENTENCES: Final = 3
"""Number of openings, and of closings, of each emotion that occur only in test passages."""


@dataclass(frozen=True, kw_only=True)
class PlannedTake:
    """One recording of the corpus.

    Attributes
    ----------
    name : str
        The recording's name, in BEAT's style.
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
        Seed of the take's random numbers.
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
    start, end = _text_ranges(emotion)[place * request.takes + take]
    name = f"{speaker.number}_{speaker.name}_0_{start}_{end}"
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
        Number of the passage, from 0. Passages repeat after all combinations of openings and
        closings: after 81, or 9 if `unheard`. The first 9, or 3, have no sentence in common.
    unheard : bool
        Whether it consists of the sentences reserved for testing.

    Returns
    -------
    str
        About twenty words, spoken in six to nine seconds.
    """
    openings, closings = (
        sentences[-RESERVED_SENTENCES:] if unheard else sentences[:-RESERVED_SENTENCES]
        for sentences in (SENTENCES[emotion]["openings"], SENTENCES[emotion]["closings"])
    )
    count = len(openings)
    opening, shift = number % count, number // count % count
    return f"{openings[opening]} {closings[(opening + shift) % count]}"


DESCRIPTION: Final = "corpus.json"


def claim_folder(folder: Path, request: CorpusRequest) -> None:
    """Record the request of a corpus in its folder.

    Raises
    ------
    InputError
        If the folder holds another corpus, or something else.
    """
    description = json.dumps(_description(request), indent=2) + "\n"
    path = folder / DESCRIPTION
    if path.exists():
        if path.read_text(encoding="utf-8") != description:
            raise InputError(
                "the folder holds another corpus, with other settings or from another version of "
                "the process or of the synthesiser",
                where=path,
                remedy="Name another folder, or remove this one",
            )
        return
    if folder.exists() and any(folder.iterdir()):
        raise InputError(
            "the folder is not empty, and holds no corpus",
            where=folder,
            remedy="Name a folder that is empty or does not exist",
        )
    write_text(path, description)


def _description(request: CorpusRequest) -> dict[str, object]:
    return {
        "corpus": "synthetic speech and motion with known truth, in the files and folders of BEAT",
        "process_version": VERSION,
        "speech": synthesiser_version(),
        **asdict(request),
    }
