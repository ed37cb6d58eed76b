"""Answers in tables, as tests write them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def cells(table: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.intp], NDArray[np.intp]]:
    """Return the values of a table, with their rows and columns; NaN is missing."""
    values = np.asarray(table, np.float64)
    rows, columns = np.nonzero(~np.isnan(values))
    return values[rows, columns], rows, columns
