"""The two-way bootstrap: participants and items are both drawn again.

Every answer of a drawn participant about a drawn item counts as often as both were drawn together
(the pigeonhole bootstrap of Owen 2007). It needs no more than the sums of each participant-item
cell, so that drawing costs two matrix products.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Floats = NDArray[np.float64]

BLOCK: Final = 500
"""Resamples drawn at a time: bounds the memory."""


@dataclass(frozen=True, kw_only=True)
class Cells:
    """Sums and counts of answers by participant and item.

    Attributes
    ----------
    sums : sparse array, shape (participants, items), for each column of the answers' values
        Sum of the values.
    counts : sparse array, shape (participants, items)
        Number of answers.
    """

    sums: tuple[sparse.csr_array, ...]
    counts: sparse.csr_array


def cells_of(
    values: Floats, participants: NDArray[np.generic], items: NDArray[np.generic]
) -> Cells:
    """Tabulate answers.

    Parameters
    ----------
    values : ndarray, shape (N,) or (N, k)
        What was answered, in one or more columns.
    participants, items : ndarray, shape (N,)
        Who answered about what.
    """
    columns = np.atleast_2d(np.asarray(values, np.float64).T)
    people, who = np.unique(participants, return_inverse=True)
    things, what = np.unique(items, return_inverse=True)
    shape = (len(people), len(things))

    def table(column: Floats) -> sparse.csr_array:
        return sparse.coo_array((column, (who, what)), shape=shape).tocsr()

    return Cells(sums=tuple(table(column) for column in columns), counts=table(np.ones(len(who))))


def bootstrap_means(cells: Cells, *, resamples: int = 10_000, seed: int = 0) -> Floats:
    """Return the means of resampled studies.

    Parameters
    ----------
    cells : Cells
        See `cells_of`.
    resamples : int
        How many to draw.
    seed : int
        The same seed gives the same resamples.

    Returns
    -------
    ndarray, shape (resamples, k)
        NaN where no answer belongs to a drawn participant and a drawn item.
    """
    chance = np.random.default_rng(seed)
    people, things = cells.counts.shape
    found = []
    for start in range(0, resamples, BLOCK):
        size = min(BLOCK, resamples - start)
        who = _drawn(chance, size, people)
        what = _drawn(chance, size, things)
        totals = np.einsum("bi,bi->b", (cells.counts.T @ who.T).T, what)
        with np.errstate(invalid="ignore", divide="ignore"):
            found.append(
                np.column_stack(
                    [
                        np.einsum("bi,bi->b", (table.T @ who.T).T, what) / totals
                        for table in cells.sums
                    ]
                )
            )
    return np.concatenate(found)


def percentile_interval(draws: Floats, level: float = 0.95) -> tuple[float, float]:
    """Return the ends between which the middle share `level` of the draws lies."""
    low, high = np.nanquantile(draws, [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)


def _drawn(chance: np.random.Generator, size: int, count: int) -> Floats:
    """Return how often each of `count` was drawn in each of `size` resamples."""
    return chance.multinomial(count, np.full(count, 1 / count), size=size).astype(np.float64)
