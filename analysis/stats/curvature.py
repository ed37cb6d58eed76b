"""Second derivatives of a function whose gradient is known exactly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STEP: Final = 1e-4
"""Step of the central differences, relative to parameters above 1."""


def second_derivatives(gradient: Callable[[Floats], Floats], at: Floats) -> Floats:
    """Return the matrix of second derivatives by central differences of `gradient`.

    Parameters
    ----------
    gradient : callable
        From parameters, shape (k,), to the gradient there, shape (k,).
    at : ndarray, shape (k,)
        Where they are wanted.
    """
    columns = []
    for place in range(len(at)):
        step = np.zeros_like(at)
        step[place] = STEP * max(1.0, abs(at[place]))
        columns.append((gradient(at + step) - gradient(at - step)) / (2 * step[place]))
    found = np.column_stack(columns)
    return np.asarray((found + found.T) / 2, np.float64)
