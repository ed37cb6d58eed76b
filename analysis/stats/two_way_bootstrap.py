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

Table = Floats | sparse.csr_array

BLOCK: Final = 500
"""Resamples drawn at a time: bounds the memory."""

FULL: Final = 0.05
"""Share of the cells that have answers from which on empty ones are kept too: products of whole
tables are so much faster."""


@dataclass(frozen=True, kw_only=True)
class Cells:
    """Sums and counts of answers by participant and item.

    Attributes
    ----------
    sums : array or sparse array, shape (participants, items), for each column of values
        Sum of the values.
    counts : array or sparse array, shape (participants, items)
        Number of answers.
    """

    sums: tuple[Table, ...]
    counts: Table


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

    def table(column: Floats) -> Table:
        found = sparse.coo_array((column, (who, what)), shape=shape).tocsr()
        return found if found.nnz < FULL * shape[0] * shape[1] else found.toarray()

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
        who = times_drawn(chance, size, people)
        what = times_drawn(chance, size, things)
        totals = _drawn_sums(cells.counts, who, what)
        with np.errstate(invalid="ignore", divide="ignore"):
            found.append(
                np.column_stack([_drawn_sums(table, who, what) / totals for table in cells.sums])
            )
    return np.concatenate(found)


def percentile_interval(draws: Floats, level: float = 0.95) -> tuple[float, float]:
    """Return the ends between which the middle share `level` of the draws lies."""
    low, high = np.nanquantile(draws, [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)


def times_drawn(chance: np.random.Generator, size: int, count: int) -> Floats:
    """Return how often each of `count` was drawn in each of `size` resamples.

    Returns
    -------
    ndarray, shape (size, count)
        Every row adds up to `count`.
    """
    drawn = chance.integers(count, size=(size, count))
    drawn += count * np.arange(size)[:, None]
    counted = np.bincount(drawn.ravel(), minlength=size * count)
    return counted.reshape(size, count).astype(np.float64)


def _drawn_sums(table: Table, who: Floats, what: Floats) -> Floats:
    """Return the sum of `table` over drawn rows and columns, for each resample."""
    by_item = who @ table if isinstance(table, np.ndarray) else (table.T @ who.T).T
    return np.asarray(np.einsum("bi,bi->b", by_item, what), np.float64)
