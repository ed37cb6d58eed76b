"""What a column of an exported table is (`columns.toml`), and its cells as CSV and as Parquet."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Final, Literal

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from motion.files import harmless_frame, replacing, write_text

ColumnType = Literal["text", "integer", "number", "boolean", "moment"]

DTYPES: Final[Mapping[ColumnType, str]] = {
    "text": "string",
    "integer": "Int64",
    "number": "Float64",
    "boolean": "boolean",
    "moment": "datetime64[us, UTC]",
}
"""How each type is held; every one knows missing values."""


@dataclass(frozen=True)
class Column:
    """One column of an exported table.

    Attributes
    ----------
    name : str
        Its heading.
    type : ColumnType
        ``moment`` is ISO 8601 in UTC in CSV, a timestamp in Parquet.
    meaning : str
        A sentence or two.
    unit : str
        Empty where there is none.
    missing : str
        When a cell is empty, in words; empty where none ever is.
    free_text : bool
        Whether people wrote it, so that it may name somebody.
    """

    name: str
    type: ColumnType
    meaning: str
    _: KW_ONLY
    unit: str = ""
    missing: str = ""
    free_text: bool = False


@dataclass(frozen=True, kw_only=True)
class TableColumns:
    """The columns of one exported table.

    Attributes
    ----------
    name : str
        What its file is called after; empty for the main table.
    title : str
        What one row is.
    columns : tuple of Column
        In their order, which does not change.
    """

    name: str
    title: str
    columns: tuple[Column, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The headings."""
        return tuple(column.name for column in self.columns)


@cache
def declared() -> Mapping[str, Any]:
    """Return what `columns.toml` says."""
    return tomllib.loads(files(__package__).joinpath("columns.toml").read_text("utf-8"))


def _table(name: str) -> TableColumns:
    """Return the columns of a table, as they are declared."""
    spec = declared()[name]
    own = declared()["several"] | spec["columns"]
    return TableColumns(
        name="" if name == "answers" else name,
        title=spec["row"],
        columns=tuple(Column(column, **own[column]) for column in spec["order"]),
    )


def bids_column(column: Column) -> Column:
    """Return `column` as BIDS names it; moments are seconds since the participant's consent."""
    return replace(column, **declared()["bids"].get(column.name, {}))


ANSWERS, PARTICIPANTS, FORM, WATCHING, REFUSALS, LOG, RECRUITER_IDS = map(
    _table, ("answers", "participants", "form", "watching", "refusals", "log", "recruiter_ids")
)
PARTICIPANT: Final = PARTICIPANTS.columns[0]


ENDINGS: Final = (".csv", ".parquet")

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


WRITTEN: Final[Mapping[ColumnType, Callable[[Any], str]]] = {
    "moment": pd.Timestamp.isoformat,
    "boolean": lambda truth: "true" if truth else "false",
}


def as_text(frame: pd.DataFrame, table: TableColumns, *, missing: str = "") -> pd.DataFrame:
    """Return the cells of a typed table as they stand in a text file.

    Moments are ISO 8601 in UTC, truth is ``true`` and ``false``, numbers have the shortest form
    that is read as the same number.
    """
    words = {
        column.name: frame[column.name]
        .astype(object)
        .map(WRITTEN.get(column.type, str), na_action="ignore")
        .astype(object)
        .fillna(missing)
        for column in table.columns
    }
    return pd.DataFrame(words, index=frame.index, dtype=object)


def write_table(path: Path, frame: pd.DataFrame, table: TableColumns) -> None:
    """Write a typed table in one step, as the ending of `path` says.

    In CSV, nothing is left that a spreadsheet runs as a formula. Parquet keeps text as it is, and
    each column's meaning and unit. Recruiters' ids are private to the owner of the file.
    """
    if path.suffix == ".csv":
        cells = harmless_frame(as_text(frame, table))
        text = cells.to_csv(index=False, lineterminator="\n")
        write_text(path, text, private=table is RECRUITER_IDS)
        return
    schema = pa.schema([_field(column) for column in table.columns])
    content = pa.Table.from_pandas(frame, schema=schema, preserve_index=False)
    with replacing(path) as draft:
        pq.write_table(content.replace_schema_metadata({"title": table.title}), draft)


def _field(column: Column) -> Any:
    about = {"meaning": column.meaning} | ({"unit": column.unit} if column.unit else {})
    return pa.field(column.name, _ARROW[column.type], metadata=about)
