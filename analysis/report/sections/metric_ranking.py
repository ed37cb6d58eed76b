"""Which conditions a metric puts first and second, in its own direction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from analysis.metrics.result import Better

ARROWS: Final[dict[Better, str]] = {
    "lower": "↓",
    "higher": "↑",
    "near the reference": "→",
    "unsaid": "",
}


def first_and_second(
    scores: Sequence[float], better: Better, recorded: float, decimals: int
) -> tuple[frozenset[int], frozenset[int]]:
    """Return the places of the best scores and of the second best.

    Scores that are the same as they are printed share a rank. Where all are the same, or there is
    one, none is best.

    Parameters
    ----------
    scores : sequence of float
        NaN where there is none, which has no rank.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores are better.
    recorded : float
        The score of recorded motion, for nearness to it; NaN where it is not known.
    decimals : int
        As many as are printed.
    """
    printed = round(recorded, decimals)
    distances = {}
    for place, score in enumerate(scores):
        distance = _distance(round(score, decimals), better, printed)
        if not math.isnan(distance):
            # Rounded once more: differences of decimal numbers are not exact.
            distances[place] = round(distance, decimals)
    ranks = sorted(set(distances.values()))
    if len(ranks) < 2:
        return frozenset(), frozenset()
    best, second = (
        frozenset(place for place, distance in distances.items() if distance == rank)
        for rank in ranks[:2]
    )
    return best, second


def _distance(score: float, better: Better, recorded: float) -> float:
    """Return how far a score is from the best that there could be; NaN where that is not said."""
    match better:
        case "lower":
            return score
        case "higher":
            return -score
        case "near the reference":
            return abs(score - recorded)
        case _:
            return math.nan
