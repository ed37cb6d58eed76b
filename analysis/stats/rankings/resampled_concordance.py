"""Kendall's W of resampled participants and segments."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.stats.rankings.placements import Placements
from analysis.stats.two_way_bootstrap import times_drawn

Floats = NDArray[np.float64]

RESAMPLES: Final = 2000
BLOCK: Final = 200
"""Resamples drawn at a time: bounds the memory."""


def resampled_concordance(
    rankings: Placements, *, resamples: int = RESAMPLES, seed: int = 0
) -> Floats:
    """Return the mean W over segments of resampled studies, shape (resamples,).

    A participant drawn twice agrees with themselves, which would raise W. So only pairs of
    different participants count: with their mean correlation r, W of n rankings is
    (1 + (n - 1) r) / n.

    Parameters
    ----------
    rankings : Placements
        Of one question; rankings that leave conditions out do not count.
    resamples, seed : int
        How many to draw, and what draws them.

    Returns
    -------
    ndarray, shape (resamples,)
        NaN where no segment drawn has two different participants who tell conditions apart.
    """
    chance = np.random.default_rng(seed)
    whole = rankings.complete
    who, what = rankings.participants[whole], rankings.segments[whole]
    centred = rankings.ranks[whole] - (len(rankings.conditions) + 1) / 2
    squares = (centred**2).sum(axis=1)
    people, things = len(rankings.participant_names), len(rankings.segment_names)
    order = np.argsort(what, kind="stable")
    bounds = np.searchsorted(what[order], np.arange(things + 1))
    own = [order[start:end] for start, end in pairwise(bounds)]
    found = []
    for start in range(0, resamples, BLOCK):
        size = min(BLOCK, resamples - start)
        by_person, by_segment = times_drawn(chance, size, people), times_drawn(chance, size, things)
        concordances = np.stack(
            [_concordance(by_person[:, who[rows]], centred[rows], squares[rows]) for rows in own],
            axis=1,
        )
        known = ~np.isnan(concordances) & (by_segment > 0)
        weights = np.where(known, by_segment, 0.0)
        with np.errstate(invalid="ignore"):
            found.append(
                (weights * np.where(known, concordances, 0.0)).sum(axis=1) / weights.sum(axis=1)
            )
    return np.concatenate(found)


def _concordance(times: Floats, centred: Floats, squares: Floats) -> Floats:
    """Return W of one segment's rankings, each counted `times`, shape (resamples, rankings)."""
    count = len(centred)
    sums = times @ centred
    pairs = (sums**2).sum(axis=1) - times**2 @ squares
    total = times.sum(axis=1)
    different = total**2 - (times**2).sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = pairs / different / (times @ squares / total)
    correlation[different <= 0] = np.nan
    return np.asarray((1 + (count - 1) * correlation) / max(count, 1), np.float64)
