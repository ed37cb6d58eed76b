"""How often a sound design misses as many intervals."""

from __future__ import annotations

from typing import Final

from scipy.stats import binom

from analysis.preferences.clustered import LEVEL

HARDLY_CHANCE: Final = 0.01
"""Below this, so many misses call for another reason than chance."""


def chance_of_missing(missed: int, intervals: int) -> float:
    """Return how often `missed` or more of so many independent intervals miss, if all is sound.

    Each misses with 1 minus its level (Binomial). Questions that the same people answer lean
    together, so that many misses at once come somewhat more often.
    """
    return float(binom.sf(missed - 1, intervals, 1 - LEVEL))


def chance_in_words(missed: int, intervals: int) -> str:
    """Return what so many misses say, as a sentence."""
    if not intervals:
        return "There is no interval to be held against what was put in."
    often = chance_of_missing(missed, intervals)
    of_all = f"{intervals} interval{'' if intervals == 1 else 's'}"
    if not missed:
        return (
            f"A sound design finds all of {of_all} right in {100 * LEVEL**intervals:.0f} of 100 "
            "rehearsals."
        )
    if often < HARDLY_CHANCE:
        return (
            f"A sound design misses {missed} or more of {of_all} in fewer than 1 of 100 "
            "rehearsals: look at who was not excluded, and at how few people or segments there are."
        )
    return (
        f"A sound design misses {missed} or more of {of_all} in {100 * often:.0f} of 100 "
        "rehearsals, and somewhat more often where several questions go to the same people."
    )
