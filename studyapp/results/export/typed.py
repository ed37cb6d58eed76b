"""Tables with types, as CSV and as Parquet: the same cells in both."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, Literal

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from motion.files import replacing
from motion.spreadsheet import harmless_frame
from studyapp.results.export.columns import DTYPES, Column, TableColumns

Format = Literal["csv", "parquet"]

_ARROW: Final = {
    "text": pa.string(),
    "integer": pa.int64(),
    "number": pa.float64(),
    "boolean": pa.bool_(),
    "moment": pa.timestamp("us", tz="UTC"),
}


def typed(frame: pd.DataFrame, table: TableColumns) -> pd.DataFrame:
    """Return the columns of `table` in their order, of their types; empty text is missing.

    Columns that `frame` does not have are missing throughout.
    """
    return pd.DataFrame(
        {column.name: _column(frame, column) for column in table.columns}, index=frame.index
    ).reset_index(drop=True)


def _column(frame: pd.DataFrame, column: Column) -> pd.Series[Any]:
    kind: Any = DTYPES[column.type]
    if column.name not in frame:
        absent: pd.Series[Any] = pd.Series(pd.NA, index=frame.index, dtype=kind)
        return absent
    cells: Any = frame[column.name].astype(object)
    cells = cells.where(cells.notna() & (cells != ""), None)
    if column.type == "moment":
        cells = pd.to_datetime(cells, utc=True, format="ISO8601")
    elif column.type in ("integer", "number"):
        cells = pd.to_numeric(cells)
    made: pd.Series[Any] = cells.astype(kind)
    return made


def as_text(frame: pd.DataFrame, table: TableColumns, *, missing: str = "") -> pd.DataFrame:
    """Return the cells of a typed table as they stand in a text file.

    Moments are ISO 8601 in UTC, truth is ``true`` and ``false``, numbers have the shortest form
    that is read as the same number.
    """
    return pd.DataFrame(
        {column.name: _words(frame[column.name], column, missing) for column in table.columns},
        index=frame.index,
        dtype=object,
    )


def _words(cells: pd.Series[Any], column: Column, missing: str) -> pd.Series[Any]:
    there = cells.notna()
    found: list[Any] = cells[there].tolist()
    if column.type == "moment":
        found = [moment.isoformat() for moment in found]
    elif column.type == "boolean":
        found = ["true" if truth else "false" for truth in found]
    elif column.type != "text":
        found = [str(number) for number in found]
    words: Any = pd.Series(missing, index=cells.index, dtype=object)
    words[there] = found
    made: pd.Series[Any] = words
    return made


def write_table(path: Path, frame: pd.DataFrame, table: TableColumns, kind: Format) -> None:
    """Write a typed table in one step.

    In CSV nothing that a spreadsheet runs as a formula is left (`motion.spreadsheet`). Parquet
    keeps text as it is, and each column's meaning and unit.
    """
    with replacing(path) as draft:
        if kind == "csv":
            cells = harmless_frame(as_text(frame, table))
            cells.to_csv(draft, index=False, lineterminator="\n")
            return
        schema = pa.schema([_field(column) for column in table.columns])
        content = pa.Table.from_pandas(frame, schema=schema, preserve_index=False)
        pq.write_table(content.replace_schema_metadata({"title": table.title}), draft)


def _field(column: Column) -> Any:
    about: Mapping[str, str] = {"meaning": column.meaning} | (
        {"unit": column.unit} if column.unit else {}
    )
    return pa.field(column.name, _ARROW[column.type], metadata=dict(about))
