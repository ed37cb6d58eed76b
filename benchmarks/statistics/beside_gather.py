"""The two-way bootstrap beside one that gathers every drawn answer by its index."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from analysis.stats.two_way_bootstrap import bootstrap_means, cells_of
from benchmarks.statistics.clock import timed

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class BesideGather:
    """The same bootstrap by both.

    Attributes
    ----------
    seconds, seconds_gather : float
        Processor time of each.
    deviations_apart : float
        Relative difference of the spreads of their means; it falls with the number of resamples.
    """

    seconds: float
    seconds_gather: float
    deviations_apart: float

    @property
    def times_faster(self) -> float:
        """The gather's time over ours."""
        return self.seconds_gather / self.seconds


def by_gather(table: Floats, resamples: int) -> Floats:
    """Return means of drawn rows and columns of `table`, gathered one resample after another."""
    chance = np.random.default_rng(0)
    rows, columns = table.shape
    return np.array(
        [
            table[np.ix_(chance.integers(rows, size=rows), chance.integers(columns, size=columns))]
            .mean()
            for _ in range(resamples)
        ]
    )  # fmt: skip


def beside_gather(
    participants: int, items: int, *, resamples: int = 10_000, turns: int = 3
) -> BesideGather:
    """Draw `resamples` of a study in which every participant answered about every item."""
    chance = np.random.default_rng(0)
    table = chance.normal(0, 0.6, (participants, 1)) + chance.normal(0, 0.45, items)
    table = table + chance.normal(size=table.shape)
    who, what = np.divmod(np.arange(table.size), items)

    def ours() -> Floats:
        return bootstrap_means(cells_of(table.ravel(), who, what), resamples=resamples)[:, 0]

    means, seconds = timed(ours, turns=turns)
    gathered, seconds_gather = timed(partial(by_gather, table, resamples))
    return BesideGather(
        seconds=seconds,
        seconds_gather=seconds_gather,
        deviations_apart=abs(float(means.std() / gathered.std()) - 1),
    )
