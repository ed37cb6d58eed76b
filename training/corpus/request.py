"""The request of a corpus, its recordings' names as in BEAT, and its self-description.

A recording is ``{number}_{name}_0_{start}_{end}``; start and end are numbers of texts, and each
emotion has its own. No two recordings of a speaker have the same pair. ``corpus.json`` in the
corpus says how it was made.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields
from itertools import islice
from pathlib import Path
from typing import Final

from pydantic import TypeAdapter, ValidationError

from motion.clip import check_frame_rate
from motion.errors import InputError
from motion.files import write_text
from motion.segment import EMOTIONS
from motion.synthesis import synthesiser_version
from training.corpus.process import VERSION
from training.data.beat import LAST_TEXTS


def _text_ranges(emotion: str) -> list[tuple[int, int]]:
    """Return possible starts and ends: single texts first, then ever longer runs of them."""
    index = EMOTIONS.index(emotion)
    first, last = (1, *(text + 1 for text in LAST_TEXTS))[index], LAST_TEXTS[index]
    return [
        (start, start + extra)
        for extra in range(last - first + 1)
        for start in range(first, last + 1 - extra)
    ]


MOST_RECORDINGS: Final = min(len(_text_ranges(emotion)) for emotion in EMOTIONS)
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
    start, end = next(islice(_text_ranges(emotion), index, None))
    return f"{speaker_number}_{speaker_name}_0_{start}_{end}"


MOST_SPEAKERS: Final = 9999
"""As many as BEAT's names can number."""


_LEAST_SHARED: Final = 4
"""Passages of an emotion that all speak: one for testing, one for validation, and two to
compare."""


@dataclass(frozen=True, kw_only=True)
class CorpusRequest:
    """The request of a corpus.

    Attributes
    ----------
    speakers : int
        Number of speakers, with held-out ones.
    sentences : int
        Passages that each speaker speaks, a multiple of eight: as many in each emotion.
    takes : int
        Number of takes of each passage.
    held_out_speakers : int
        The last speakers, whose takes are all for testing.
    frame_rate : float
        Frames per second of the body's motion.
    seed : int
        Of all random numbers, at least 0.
    shared_passages : bool
        Whether all speakers speak the same passages, as BEAT's do, rather than their own.

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


DESCRIPTION: Final = "corpus.json"

_SHARED: Final = "shared_passages"
"""Recorded only if true."""


def claim_folder(folder: Path, request: CorpusRequest) -> None:
    """Record in a folder which corpus it holds.

    Raises
    ------
    InputError
        If it holds another one, or something else.
    """
    description = json.dumps(_description(request), indent=2) + "\n"
    path = folder / DESCRIPTION
    if path.exists():
        if path.read_text(encoding="utf-8") != description:
            raise InputError(
                "the folder holds another corpus: of other numbers, or made with another version "
                "of the process or of the synthesiser",
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


def read_request(folder: Path) -> CorpusRequest:
    """Return the request of the corpus in a folder.

    Raises
    ------
    InputError
        If it holds none, or one of another version of the process, whose truth cannot be computed.
    """
    path = folder / DESCRIPTION
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        version = content["process_version"]
        settings = {
            field.name: content[field.name]
            for field in fields(CorpusRequest)
            if field.name in content or field.name != _SHARED
        }
        request = TypeAdapter(CorpusRequest).validate_python(settings)
    except (OSError, ValueError, KeyError, TypeError, ValidationError) as error:
        raise InputError(
            "the folder holds no synthetic corpus",
            where=path,
            remedy="Give a folder that 'motionjury corpus' made",
        ) from error
    if version != VERSION:
        raise InputError(
            f"the corpus was made by version {version} of the process, this is version {VERSION}",
            where=path,
            remedy="Make the corpus again",
        )
    return request


def _description(request: CorpusRequest) -> dict[str, object]:
    return {
        "corpus": "synthetic speech and motion with known truth, in the files and folders of BEAT",
        "process_version": VERSION,
        "speech": synthesiser_version(),
        **{key: value for key, value in asdict(request).items() if value or key != _SHARED},
    }
