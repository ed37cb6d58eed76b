"""Checking a table column by column: every distinct cell once, and the first bad row named."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import ValidationError

from analysis.answers.cells import Cells
from analysis.answers.columns import Column
from motion.errors import InputError

Rows = NDArray[np.bool_]
Codes = NDArray[np.intp]


class Checking:
    """A table whose columns are checked one after the other.

    Parameters
    ----------
    cells : Cells
        The file's text.
    analysed : ndarray of bool, shape (N,)
        Which rows are those of main and repeated trials, which need more cells than others.
    """

    def __init__(self, cells: Cells, analysed: Rows | None = None) -> None:
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

    def numbers(self, column: Column) -> NDArray[np.float64]:
        """Return a column of numbers, NaN where a cell is empty."""
        codes, values = self._distinct(column)
        return np.append(np.asarray(values, np.float64), np.nan)[codes]

    def filled(self, column: Column) -> Rows:
        """Tell which rows have a cell of `column` that is not empty."""
        if column.name not in self._cells.rows:
            return np.zeros(len(self._cells.rows), bool)
        codes, texts = pd.factorize(self._cells.rows[column.name])
        return np.array([str(text).strip() not in column.missing for text in texts], bool)[codes]

    def refuse(self, bad: Rows, column: str, what: Callable[[int], str], remedy: str) -> None:
        """Raise an error about the first row of `bad`, if there is one.

        Raises
        ------
        InputError
            With the file, the row and the column.
        """
        if bad.any():
            row = int(bad.argmax())
            raise InputError(what(row), where=self._cells.place(row, column), remedy=remedy)

    def number_of(self, row: int) -> int:
        """Return how a person finds a row."""
        return int(self._cells.numbers[row])

    def _distinct(self, column: Column) -> tuple[Codes, list[Any]]:
        """Return the values of filled cells, and for each row which one it is; -1 for none."""
        if column.name not in self._cells.rows:
            return np.full(len(self._cells.rows), -1, np.intp), []
        codes, texts = pd.factorize(self._cells.rows[column.name])
        words = [str(text).strip() for text in texts]
        filled = np.array([word not in column.missing for word in words], bool)
        self._require_filled(column, ~filled[codes])
        try:
            values = column.cells.validate_python(
                [word for word, full in zip(words, filled, strict=True) if full]
            )
        except ValidationError as error:
            places = [int(one["loc"][0]) for one in error.errors()]
            self.refuse(
                np.isin(codes, np.flatnonzero(filled)[places]),
                column.name,
                lambda row: f"{words[codes[row]]!r} is not {column.meaning}",
                "Correct the cell, or remove the row",
            )
            raise
        return np.where(filled, np.cumsum(filled) - 1, -1)[codes], values

    def _require_filled(self, column: Column, empty: Rows) -> None:
        if column.needed == "no":
            return
        self.refuse(
            empty & (self.analysed | (column.needed == "always")),
            column.name,
            lambda _: f"the cell is empty, not {column.meaning}",
            "Fill it in, or remove the row",
        )
