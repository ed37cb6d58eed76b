"""How much people prefer each condition, in the study and in resamples of its people and items."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.results.against_people.drawn_strengths import drawn_strengths
from analysis.results.against_people.tallies import Tallies
from analysis.stats.two_way_bootstrap import Table, times_drawn

Floats = NDArray[np.float64]

RESAMPLES: Final = 2_000

_BLOCK: Final = 4_000_000
"""Sums held at a time: bounds the memory."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnPreferences:
    """Preferences of all conditions.

    Attributes
    ----------
    estimates : ndarray, shape (conditions,)
        In the study; NaN where conditions cannot be set against each other.
    draws : ndarray, shape (B, conditions)
        In each resample; NaN where it says nothing of a condition.
    segments : ndarray, shape (B, segments)
        How often each resample draws each segment.
    """

    estimates: Floats
    draws: Floats
    segments: Floats


def drawn_preferences(found: Tallies, *, resamples: int, seed: int) -> DrawnPreferences:
    """Draw participants and segments again, both together, and score the conditions each time.

    An answer counts as often as its participant and its segment were drawn together (the
    pigeonhole bootstrap of Owen 2007).

    Parameters
    ----------
    found : Tallies
        The answers.
    resamples : int
        How many studies to draw.
    seed : int
        The same seed gives the same resamples.
    """
    chance = np.random.default_rng(seed)
    sums, counts = found.cells
    scores, chosen = [], []
    block = max(1, min(resamples, _BLOCK // max(counts.size, found.participants)))
    for start in range(0, resamples, block):
        size = min(block, resamples - start)
        who = times_drawn(chance, size, found.participants)
        what = times_drawn(chance, size, len(found.segments))
        drawn = [
            _drawn_sums(table, who, what, counts.shape) for table in (found.sums, found.counts)
        ]
        scores.append(_scores(found, *drawn))
        chosen.append(what)
    return DrawnPreferences(
        estimates=_scores(found, sums.sum(axis=1)[None], counts.sum(axis=1)[None])[0],
        draws=np.concatenate(scores),
        segments=np.concatenate(chosen),
    )


def _drawn_sums(table: Table, who: Floats, what: Floats, shape: tuple[int, ...]) -> Floats:
    """Return the sum of each group over drawn participants and segments, shape (B, G)."""
    by_cell = who @ table if isinstance(table, np.ndarray) else (table.T @ who.T).T
    return np.asarray(np.einsum("bgi,bi->bg", by_cell.reshape(-1, *shape), what))


def _scores(found: Tallies, sums: Floats, counts: Floats) -> Floats:
    """Return the preference of each condition from sums and counts by group, shape (B, G)."""
    if found.groups.shape[1] == 1:
        with np.errstate(invalid="ignore", divide="ignore"):
            return sums / counts
    first, second = found.groups.T
    size = len(found.conditions)
    wins = np.zeros((len(sums), size, size))
    wins[:, first, second] = sums
    wins[:, second, first] = counts - sums
    return drawn_strengths(wins)
