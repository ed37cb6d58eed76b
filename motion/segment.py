"""Speech segments, the excerpts that all conditions of a study have in common, and their table."""

import csv
import io
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Final

from motion.errors import InputError, found_at
from motion.files import write_text

EMOTIONS: Final = (
    "neutral",
    "happiness",
    "anger",
    "sadness",
    "contempt",
    "surprise",
    "fear",
    "disgust",
)
"""The eight emotion labels of BEAT (Liu et al. 2022), which AMUSE's study uses too."""

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,99}")


def check_name(name: str, kind: str, where: object = "") -> str:
    """Return `name` if it is safe as a file name in a study folder, else raise `InputError`."""
    if not _NAME.fullmatch(name):
        raise InputError(
            f"{name[:200]!r} is not a usable {kind} name",
            where=where,
            remedy="Use up to 100 letters, digits, '_', '-' and '.', starting with a letter or "
            "digit",
        )
    return name


@dataclass(frozen=True, kw_only=True)
class Segment:
    """One speech excerpt.

    Attributes
    ----------
    name : str
        Identifies the segment within its study; also the stem of its files.
    wav : str
        File name of the speech, relative to the study's ``speech`` folder.
    start, end : float
        Position of the excerpt in `wav` in seconds, ``0 <= start < end``.
    speaker : str
        Name of the speaker.
    emotion : str
        One of `EMOTIONS`.
    transcript : str
        The spoken text; empty if unknown.
    """

    name: str
    wav: str
    start: float
    end: float
    speaker: str
    emotion: str
    transcript: str = ""

    def __post_init__(self) -> None:
        check_name(self.name, "segment")
        if Path(self.wav).name != self.wav:
            raise InputError(
                f"segment {self.name}: wav {self.wav!r} must be a plain file name",
                remedy="Put the file into the study's speech folder and give its name alone",
            )
        if not 0 <= self.start < self.end < math.inf:
            raise InputError(
                f"segment {self.name}: start {self.start} and end {self.end} make no excerpt",
                remedy="Give 0 <= start < end in seconds",
            )
        if self.emotion not in EMOTIONS:
            raise InputError(
                f"segment {self.name}: unknown emotion {self.emotion!r}",
                remedy=f"Use one of {', '.join(EMOTIONS)}",
            )

    @property
    def duration(self) -> float:
        """Length of the excerpt in seconds."""
        return self.end - self.start


CUT_TOLERANCE: Final = 0.1
"""Seconds by which an excerpt may extend past the end of its recording or clip."""


def excerpt_bounds(start: float, end: float, *, rate: float, length: int) -> tuple[int, int]:
    """Return the first item of an excerpt and its number of items.

    Parameters
    ----------
    start, end : float
        Seconds, ``0 <= start < end``.
    rate : float
        Items (samples, frames) per second.
    length : int
        Number of items. An excerpt may extend past them by up to `CUT_TOLERANCE` seconds.

    Returns
    -------
    first : int
        ``round(start * rate)``, below `length`.
    count : int
        ``round((end - start) * rate)``, at least 1.

    Raises
    ------
    InputError
        If the excerpt is empty or outside the items.
    """
    duration = length / rate
    if 0 <= start < end <= duration + CUT_TOLERANCE:
        first, count = round(start * rate), round((end - start) * rate)
        if first < length and count >= 1:
            return first, count
    raise InputError(
        f"there is no excerpt from {start:g} s to {end:g} s in {duration:.2f} s",
        remedy="Give 0 <= start < end within the recording",
    )


SEGMENTS_FILE: Final = "segments.csv"
COLUMNS: Final = tuple(field.name for field in fields(Segment))


def read_segments(speech_folder: Path) -> tuple[Segment, ...]:
    """Read and check the segments of a study.

    Parameters
    ----------
    speech_folder : Path
        The folder that holds ``segments.csv`` and the wav files it names.

    Returns
    -------
    tuple of Segment
        In the order of the table.

    Raises
    ------
    InputError
        If the table is missing or empty, a column is missing or unknown, a name occurs twice,
        a number or emotion is unusable, or a wav file is not in the folder. The message names
        the file and the line.
    """
    table = Path(speech_folder) / SEGMENTS_FILE
    segments: list[Segment] = []
    line_of: dict[str, int] = {}
    for line, row in _rows(table):
        where = f"{table}, line {line}"
        segment = _segment(row, where)
        if segment.name in line_of:
            raise InputError(
                f"segment {segment.name!r} is already on line {line_of[segment.name]}",
                where=where,
                remedy="Give every segment its own name",
            )
        if not (table.parent / segment.wav).is_file():
            raise InputError(
                f"there is no file {segment.wav!r} in {table.parent}",
                where=where,
                remedy="Put the file there or correct the name",
            )
        line_of[segment.name] = line
        segments.append(segment)
    if not segments:
        raise InputError("the table holds no segment", where=table, remedy="Add a row per segment")
    return tuple(segments)


def _rows(table: Path) -> list[tuple[int, Mapping[str, str]]]:
    """Return each row that is not blank as text by column name, with its line number."""
    try:
        text = table.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise InputError(
            "there is no speech yet: the table of its segments is missing",
            where=table,
            remedy="Bring recordings in with 'motionjury import', or make the table with the "
            f"columns {','.join(COLUMNS)}",
        ) from error
    except UnicodeDecodeError as error:
        raise InputError(
            "the table is not UTF-8 text", where=table, remedy="Save it as CSV in UTF-8"
        ) from error
    reader = csv.DictReader(io.StringIO(text, newline=""), strict=True)
    try:
        header = reader.fieldnames = [name.strip() for name in reader.fieldnames or ()]
        rows = [(reader.line_num, row) for row in reader]
    except csv.Error as error:
        raise InputError(
            f"the table is not CSV: {error}",
            where=f"{table}, line {reader.reader.line_num}",
            remedy="Close every double quote, double those within a text, and save as CSV in UTF-8",
        ) from error
    if sorted(header) != sorted(COLUMNS):
        raise InputError(
            f"the columns are {','.join(header)!r}",
            where=f"{table}, line 1",
            remedy=f"Give exactly the columns {','.join(COLUMNS)}, separated by commas",
        )
    for line, row in rows:
        if None in row or None in row.values():
            raise InputError(
                f"the row does not have {len(header)} cells, one for each column",
                where=f"{table}, line {line}",
                remedy="Put a transcript that holds commas in double quotes",
            )
    return [(line, row) for line, row in rows if any(cell.strip() for cell in row.values())]


def _segment(row: Mapping[str, str], where: str) -> Segment:
    """Return the segment that `row` describes."""
    with found_at(where):
        return Segment(
            name=row["name"].strip(),
            wav=row["wav"].strip(),
            start=_seconds(row, "start"),
            end=_seconds(row, "end"),
            speaker=row["speaker"].strip(),
            emotion=row["emotion"].strip(),
            transcript=row["transcript"],
        )


def _seconds(row: Mapping[str, str], column: str) -> float:
    try:
        return float(row[column])
    except ValueError as error:
        raise InputError(
            f"{column} {row[column]!r} is not a number", remedy="Give seconds such as 12.5"
        ) from error


def write_segments(speech_folder: Path, segments: Iterable[Segment]) -> None:
    """Write the table of `segments` into `speech_folder`, whole or not at all."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(map(astuple, segments))
    write_text(Path(speech_folder) / SEGMENTS_FILE, text.getvalue())
