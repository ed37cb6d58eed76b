"""Tables as the Brain Imaging Data Structure has them, which knows behavioural data too.

Version 1.11: tab-separated, ``n/a`` for what is missing, and beside each table a JSON file that
says what its columns mean.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import pandas as pd

from motion.files import write_text
from motion.spreadsheet import harmless_frame
from studyapp.researchers.pseudonyms import FOLDER
from studyapp.results.export.codebook import as_json
from studyapp.results.export.columns import PARTICIPANT, Column, TableColumns, bids_column
from studyapp.results.export.labels import column_labels
from studyapp.results.export.typed import as_text
from studyapp.study.settings.study import Study

BIDS_VERSION: Final = "1.11.0"
MISSING: Final = "n/a"

LEFT_OUT: Final = ("answered_at", "consented_at")
"""Moments that say nothing more than the others do."""

PARTICIPANT_ID: Final = replace(
    PARTICIPANT,
    name="participant_id",
    meaning="The participant: sub- and a pseudonym, which is a keyed hash. Without the key, which "
    "stays with the researchers, it leads back to nobody.",
)


def folder_name(pseudonym: str) -> str:
    """Return the name of a participant's folder, which is their name in all tables."""
    return f"{FOLDER}{pseudonym}"


def bids_table(
    frame: pd.DataFrame, about: TableColumns, consents: Mapping[str, pd.Timestamp]
) -> tuple[pd.DataFrame, TableColumns]:
    """Return a typed table under BIDS' headings, without a moment.

    Parameters
    ----------
    frame, about
        A table with the column ``participant``.
    consents : mapping of pseudonym to Timestamp
        When each participant agreed.
    """
    began = pd.to_datetime(frame["participant"].map(dict(consents)), utc=True)
    columns: list[Column] = [PARTICIPANT_ID]
    cells: dict[str, Any] = {"participant_id": frame["participant"].map(folder_name)}
    for column in about.columns:
        if column.name in LEFT_OUT or column.name == "participant":
            continue
        own = bids_column(column)
        columns.append(own)
        cells[own.name] = (
            (frame[column.name] - began).dt.total_seconds().round(3)
            if column.type == "moment"
            else frame[column.name]
        )
    return pd.DataFrame(cells), replace(about, columns=tuple(columns))


def write_tsv(path: Path, frame: pd.DataFrame, about: TableColumns) -> None:
    """Write a typed table as BIDS wants it."""
    cells = harmless_frame(as_text(frame, about, missing=MISSING))
    # Line ends within a cell would end its row for many readers.
    cells = cells.map(lambda cell: " ".join(cell.split()) if isinstance(cell, str) else cell)
    write_text(path, cells.to_csv(index=False, sep="\t", lineterminator="\n"))


def write_descriptions(
    path: Path,
    about: TableColumns,
    study: Study,
    *,
    more: Mapping[str, Any] | None = None,
    labels: Mapping[str, Mapping[str, str]] | None = None,
) -> None:
    """Write what the columns of a table mean.

    Parameters
    ----------
    more : mapping, optional
        What is said about the table as a whole.
    labels : mapping of column name to mapping, optional
        Values and what they mean, of columns that the study has no labels for.
    """
    write_text(
        path,
        as_json(
            dict(more or {})
            | {column.name: _described(column, study, labels or {}) for column in about.columns}
        ),
    )


def _described(
    column: Column, study: Study, labels: Mapping[str, Mapping[str, str]]
) -> dict[str, Any]:
    missing = f" {MISSING} where {column.missing}." if column.missing else ""
    free = " Free text." if column.free_text else ""
    described: dict[str, Any] = {"Description": f"{column.meaning}{missing}{free}"}
    if column.unit:
        described["Units"] = column.unit
    values = labels.get(column.name) or column_labels(study, column.name)
    if values:
        described["Levels"] = dict(values)
    return described
