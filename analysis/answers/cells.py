"""The cells of a CSV or Parquet file, and checking them column by column."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
from pydantic import ValidationError

from analysis.answers.table import Column
from motion.arrays import Bools, Floats, Indices
from motion.errors import InputError
from motion.files import APOSTROPHE, cell_as_given

PARQUET: Final = (".parquet", ".pq")
"""Endings of Parquet files; everything else is read as CSV."""

_SEPARATORS: Final = (",", ";", "\t")


@dataclass(frozen=True, kw_only=True, eq=False)
class Cells:
    """The cells of a file.

    Attributes
    ----------
    path : Path
        The file.
    rows : DataFrame
        The cells as text, '' if empty; empty rows are dropped.
    numbers : Index
        Each row's number for a reader: its line in CSV, where the header is line 1; in Parquet
        counted from 1.
    ignored : tuple of str
        Columns that are not read.
    """

    path: Path
    rows: pd.DataFrame
    numbers: pd.Index[int]
    ignored: tuple[str, ...]

    def part(self, rows: Bools) -> Cells:
        """Return the selected rows."""
        return replace(
            self, rows=self.rows[rows].reset_index(drop=True), numbers=self.numbers[rows]
        )

    def place(self, row: int, column: str) -> str:
        """Return a cell's location; `row` counts from 0."""
        return f"{self.path.name}, row {self.numbers[row]}, column {column}"


def read_cells(path: Path, columns: Sequence[str], required: Sequence[str]) -> Cells:
    """Read the columns `columns` of a file as text.

    Raises
    ------
    InputError
        If the file cannot be read, a column of `required` is missing, or a heading occurs twice.
    """
    try:
        if path.suffix.lower() in PARQUET:
            header = list(pq.read_schema(path).names)
            _check_header(path, header, required)
            rows = _parquet(path, [name for name in header if name in columns])
            first = 1
        else:
            header, separator = _csv_header(path)
            _check_header(path, header, required)
            rows = _csv(path, header, separator)[[name for name in header if name in columns]]
            first = 2
    except FileNotFoundError:
        raise InputError("there is no such file", where=path, remedy="Check the path") from None
    except OSError as error:
        raise InputError(
            f"the file cannot be read: {error.strerror or error}",
            where=path,
            remedy="Check the path, and that it is CSV in UTF-8 or Parquet",
        ) from error
    except (UnicodeDecodeError, csv.Error, pd.errors.ParserError, pa.ArrowInvalid) as error:
        raise InputError(
            f"neither CSV in UTF-8 nor Parquet: {' '.join(str(error).split())}",
            where=path,
            remedy="Save the table as CSV in UTF-8, or as Parquet with the ending .parquet",
        ) from error
    rows = rows.reset_index(drop=True)
    filled = (rows != "").any(axis=1)
    return Cells(
        path=path,
        rows=rows[filled].reset_index(drop=True),
        numbers=rows.index[filled] + first,
        ignored=tuple(name for name in header if name not in columns and name),
    )


def _check_header(path: Path, header: Sequence[str], required: Sequence[str]) -> None:
    missing = [name for name in required if name not in header]
    if missing:
        raise InputError(
            f"the table has no {'column' if len(missing) == 1 else 'columns'} "
            f"{', '.join(missing)}; it has {', '.join(header) or 'none'}",
            where=path,
            remedy=f"Name the columns {', '.join(required)}",
        )
    duplicates = sorted({name for name in header if name and header.count(name) > 1})
    if duplicates:
        raise InputError(
            f"column {', '.join(duplicates)} occurs twice", where=path, remedy="Keep one of them"
        )


def _csv_header(path: Path) -> tuple[list[str], str]:
    """Return the headings and their separator: a comma, a semicolon or a tab."""
    with path.open(encoding="utf-8-sig", newline="") as stream:
        start = stream.readline()
        stream.seek(0)
        separator = max(_SEPARATORS, key=start.count)
        names = next(csv.reader(stream, delimiter=separator), [])
    return [name.strip() for name in names], separator


def _csv(path: Path, header: Sequence[str], separator: str) -> pd.DataFrame:
    names = [name or f"column {place}" for place, name in enumerate(header)]
    cells = pd.read_csv(
        path,
        sep=separator,
        names=names,
        skiprows=1,
        dtype=str,
        keep_default_na=False,
        na_filter=False,
        skip_blank_lines=False,
        index_col=False,
        encoding="utf-8-sig",
    ).fillna("")
    return cells.apply(_as_given)


def _as_given(column: pd.Series[str]) -> pd.Series[str]:
    """Remove the apostrophes that keep spreadsheets from running cells as formulas."""
    marked = column.str.startswith(APOSTROPHE)
    return column.mask(marked, column[marked].map(cell_as_given)) if marked.any() else column


def _parquet(path: Path, names: Sequence[str]) -> pd.DataFrame:
    table = pq.read_table(path, columns=list(names)).to_pandas()
    return pd.DataFrame({name: _text(table[name]) for name in names}, columns=list(names))


def _text(column: pd.Series[Any]) -> pd.Series[str]:
    """Return a column as text; whole numbers stay whole even if a gap made the column float."""
    values: pd.Series[Any] = column
    if pd.api.types.is_float_dtype(column.dtype):
        values = column.astype("Float64").convert_dtypes()
    return values.astype("str").where(column.notna().to_numpy(bool), "")


class Checking:
    """Checks a table column by column.

    Parameters
    ----------
    cells : Cells
        The file's text.
    analysed : ndarray of bool, shape (N,)
        Rows of main and repeated trials, which need more cells than others.
    """

    def __init__(self, cells: Cells, analysed: Bools | None = None) -> None:
        self._cells = cells
        self.analysed = np.ones(len(cells.rows), bool) if analysed is None else analysed

    def names(self, column: Column) -> pd.Categorical:
        """Return a column of names as categories, in the order of appearance."""
        codes, values = self._distinct(column)
        # Cells that differed by blanks alone are one name.
        name_of, names = pd.factorize(np.array(values, object))
        return pd.Categorical.from_codes(
            np.append(name_of, -1)[codes], categories=pd.Index(list(names), dtype=object)
        )

    def numbers(self, column: Column) -> Floats:
        """Return a column of numbers, with NaN for empty cells."""
        codes, values = self._distinct(column)
        return np.append(np.asarray(values, np.float64), np.nan)[codes]

    def refuse(self, bad: Bools, column: str, problem: Callable[[int], str], remedy: str) -> None:
        """Raise an error about the first row of `bad`, if there is one.

        Raises
        ------
        InputError
            With the file, the row and the column.
        """
        if bad.any():
            row = int(bad.argmax())
            raise InputError(problem(row), where=self._cells.place(row, column), remedy=remedy)

    def number_of(self, row: int) -> int:
        """Return the number of a row in the file."""
        return int(self._cells.numbers[row])

    def _distinct(self, column: Column) -> tuple[Indices, list[Any]]:
        """Return each row's index into the values, -1 for an empty cell, and the values."""
        if column.name not in self._cells.rows:
            return np.full(len(self._cells.rows), -1, np.intp), []
        codes, texts = pd.factorize(self._cells.rows[column.name])
        words = [str(text).strip() for text in texts]
        filled = np.array([word not in column.missing for word in words], bool)
        if column.needed != "no":
            self.refuse(
                ~filled[codes] & (self.analysed | (column.needed == "always")),
                column.name,
                lambda _: f"the cell is empty, not {column.meaning}",
                "Fill it in, or remove the row",
            )
        try:
            values = column.cells.validate_python(
                [word for word, full in zip(words, filled, strict=True) if full]
            )
        except ValidationError as error:
            places = [int(detail["loc"][0]) for detail in error.errors()]
            self.refuse(
                np.isin(codes, np.flatnonzero(filled)[places]),
                column.name,
                lambda row: f"{words[codes[row]]!r} is not {column.meaning}",
                "Correct the cell, or remove the row",
            )
            raise
        return np.where(filled, np.cumsum(filled) - 1, -1)[codes], values
