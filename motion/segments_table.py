"""The table of a study's speech segments: ``speech/segments.csv``."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Final

from motion.errors import InputError, found_at
from motion.files import write_text
from motion.segment import Segment

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
                remedy="Give every segment a name of its own",
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
            "the table of speech segments is missing",
            where=table,
            remedy=f"Make it with the columns {','.join(COLUMNS)}",
        ) from error
    except UnicodeDecodeError as error:
        raise InputError(
            "the table is not UTF-8 text", where=table, remedy="Save it as CSV in UTF-8"
        ) from error
    try:
        return _parse(text, table)
    except csv.Error as error:
        raise InputError(
            f"the table is not CSV: {error}", where=table, remedy="Save it as CSV in UTF-8"
        ) from error


def _parse(text: str, table: Path) -> list[tuple[int, Mapping[str, str]]]:
    reader = csv.reader(io.StringIO(text, newline=""))
    header = [cell.strip() for cell in next(reader, [])]
    if sorted(header) != sorted(COLUMNS):
        raise InputError(
            f"the columns are {','.join(header)!r}",
            where=f"{table}, line 1",
            remedy=f"Give exactly the columns {','.join(COLUMNS)}, separated by commas",
        )
    rows: list[tuple[int, Mapping[str, str]]] = []
    for cells in reader:
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(header):
            raise InputError(
                f"the row has {len(cells)} cells for {len(header)} columns",
                where=f"{table}, line {reader.line_num}",
                remedy="Put a transcript that holds commas in double quotes",
            )
        rows.append((reader.line_num, dict(zip(header, cells, strict=True))))
    return rows


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
    for segment in segments:
        writer.writerow([getattr(segment, column) for column in COLUMNS])
    write_text(Path(speech_folder) / SEGMENTS_FILE, text.getvalue())
