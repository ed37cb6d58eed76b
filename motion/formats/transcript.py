"""Transcripts with word times: a TextGrid, a table, or plain text spread over the speech."""

import csv
import io
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from motion.arrays import Floats
from motion.audio import Audio
from motion.errors import InputError

TRANSCRIPT_ENDINGS: Final = (".textgrid", ".csv", ".lab")
"""In order of preference. Montreal Forced Aligner calls plain text ``.lab``."""

FASTEST: Final = 8.0
"""Words per second of the fastest intelligible speech."""

_ENDINGS_SEARCHED: Final = (".TextGrid", ".textgrid", ".csv", ".lab", ".txt")
_MIN_SHARED_WORDS: Final = 0.5
"""Smallest share of the known words that their transcript has."""
_TABLE: Final = ("word", "start", "end")
_WORD_TIERS: Final = ("words", "word")
_OVERSHOOT: Final = 0.5
"""Seconds by which a word may end after the speech."""
_SPEECH_LOUDNESS: Final = 0.05
"""Level below which there is no speech, as a share of the loudest 10 ms."""
_STEP: Final = 0.01
_LETTERS: Final = re.compile(r"\w[\w'’-]*")


@dataclass(frozen=True)
class Word:
    """A word and its time in seconds from the beginning of the speech."""

    text: str
    start: float
    end: float


def read_transcript(path: Path, audio: Audio) -> tuple[Word, ...]:
    """Return the words of `audio`.

    Parameters
    ----------
    path : Path
        A TextGrid with a tier of words (named ``words``, or the first one of intervals); a CSV
        table with the columns word, start and end; or plain text for `spread_words`.
    audio : Audio
        The speech.

    Raises
    ------
    InputError
        If the file cannot be read, or belongs to other speech: words end after the audio, or there
        are more than anyone can say in that time.
    """
    try:
        words = _read(path, audio)
        _check(words, audio)
    except InputError as error:
        raise InputError(error.what, where=error.where or path, remedy=error.remedy) from error
    return words


def find_transcript(folder: Path | None, name: str, known: str, audio: Audio) -> tuple[Word, ...]:
    """Return the words of `audio` from the transcript `name` in `folder`.

    Parameters
    ----------
    folder : Path or None
        Folder of files for `read_transcript`; None spreads the known text over the speech.
    name : str
        The file's name without its ending.
    known : str
        The known text; may be empty.
    audio : Audio
        The speech.

    Raises
    ------
    InputError
        If the transcript is missing, cannot be read, or has less than half of the known words.
    """
    if folder is None:
        return spread_words(known, audio)
    paths = (folder / f"{name}{ending}" for ending in _ENDINGS_SEARCHED)
    path = next((path for path in paths if path.is_file()), None)
    if path is None:
        raise InputError(
            f"there is no transcript of {name}",
            where=folder,
            remedy=f"Put {name} with one of {', '.join(_ENDINGS_SEARCHED)} there",
        )
    words = read_transcript(path, audio)
    expected, transcribed = set(words_of(known)), {word.text for word in words}
    if expected and len(expected & transcribed) < _MIN_SHARED_WORDS * len(expected):
        raise InputError(
            f"the transcript has other words than segment {name} in segments.csv",
            where=path,
            remedy="Give the transcript of this speech, or correct segments.csv",
        )
    return words


def spread_words(text: str, audio: Audio) -> tuple[Word, ...]:
    """Return the words of a text, spread over the speech in proportion to their letters.

    Raises
    ------
    InputError
        If there are more words than anyone can say in that time.
    """
    texts = words_of(text)
    if not texts:
        return ()
    spoken = _speech_times(audio)
    ends = np.cumsum([len(word) + 1 for word in texts], dtype=np.float64)
    places = np.concatenate([[0.0], ends / ends[-1]]) * len(spoken)
    times = np.interp(places, np.arange(len(spoken) + 1), np.append(spoken, spoken[-1] + _STEP))
    words = tuple(
        Word(word, float(start), float(end))
        for word, start, end in zip(texts, times[:-1], times[1:], strict=True)
    )
    _check(words, audio)
    return words


def words_of(text: str) -> tuple[str, ...]:
    """Return the words of a text in lower case, without punctuation."""
    return tuple(_LETTERS.findall(text.lower()))


def preferred_transcript(find: Callable[[str], Path | None]) -> Path | None:
    """Return the first transcript that `find` returns for `TRANSCRIPT_ENDINGS`, in lower case.

    CSV files without words do not count.
    """
    for ending in TRANSCRIPT_ENDINGS:
        path = find(ending)
        if path is not None and (ending != ".csv" or is_word_table(path)):
            return path
    return None


def is_word_table(path: Path) -> bool:
    """Return whether a CSV file is a table of words."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            return set(_TABLE) <= set(next(csv.reader(file), ()))
    except (OSError, UnicodeDecodeError):
        return False


def _read(path: Path, audio: Audio) -> tuple[Word, ...]:
    ending = path.suffix.lower()
    if ending == ".textgrid":
        return _read_text_grid(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            "the transcript cannot be read", remedy="Give a TextGrid, CSV or text in UTF-8"
        ) from error
    return _read_table(text, path) if ending == ".csv" else spread_words(text, audio)


def _read_text_grid(path: Path) -> tuple[Word, ...]:
    # Imported here: few need it.
    from praatio import textgrid
    from praatio.utilities.constants import INTERVAL_TIER

    try:
        grid = textgrid.openTextgrid(str(path), includeEmptyIntervals=False)
        tiers = [tier for tier in grid.tiers if tier.tierType == INTERVAL_TIER]
        word_tiers = [tier for tier in tiers if tier.name.lower() in _WORD_TIERS]
        entries = (word_tiers or tiers)[0].entries
    except Exception as error:  # praatio raises whatever its parsing runs into
        raise InputError(
            "the file is not a TextGrid with a tier of words",
            remedy="Save it with Praat or an aligner, with intervals in a tier named words",
        ) from error
    return _words([(entry.label, entry.start, entry.end) for entry in entries])


def _read_table(text: str, path: Path) -> tuple[Word, ...]:
    rows = csv.DictReader(io.StringIO(text))
    if not set(_TABLE) <= set(rows.fieldnames or ()):
        raise InputError(
            "the table has no words", remedy=f"Give a header with {', '.join(_TABLE)}; seconds"
        )
    try:
        intervals = [(row["word"] or "", float(row["start"]), float(row["end"])) for row in rows]
    except (TypeError, ValueError) as error:
        raise InputError(
            "the row has no time", where=f"{path}, line {rows.line_num}", remedy="Give seconds"
        ) from error
    return _words(intervals)


def _words(intervals: Sequence[tuple[str, float, float]]) -> tuple[Word, ...]:
    words = []
    for label, start, end in intervals:
        if not 0 <= start <= end < math.inf:
            raise InputError(
                f"the word {label!r} starts at {start:g} s and ends at {end:g} s",
                remedy="Give 0 <= start <= end",
            )
        words += [Word(text, start, end) for text in words_of(label)]
    return tuple(sorted(words, key=lambda word: word.start))


def _check(words: Sequence[Word], audio: Audio) -> None:
    seconds = audio.duration
    end = max((word.end for word in words), default=0.0)
    if end > seconds + _OVERSHOOT or len(words) > max(3.0, FASTEST * seconds):
        raise InputError(
            f"the transcript belongs to other speech: it has {len(words)} words until {end:.1f} s, "
            f"and the speech lasts {seconds:.1f} s",
            remedy="Give the transcript of this speech, or none",
        )


def _speech_times(audio: Audio) -> Floats:
    """Return the times of speech in steps of 10 ms; all times if there is none."""
    step = max(1, round(_STEP * audio.sample_rate))
    size = len(audio.samples) // step * step
    if not size:
        return np.zeros(1)
    loud = np.sqrt(np.mean(audio.samples[:size].astype(np.float64).reshape(-1, step) ** 2, axis=1))
    steps = np.flatnonzero(loud > _SPEECH_LOUDNESS * loud.max())
    return np.asarray((steps if len(steps) else np.arange(len(loud))) * _STEP, np.float64)
