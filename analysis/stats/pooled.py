"""Tests that take every single answer for an independent one.

Where participants or segments differ, they find effects that are not there: with standard
deviations of .6 and .45 logits, 22 participants and 24 segments three times in ten instead of
once in twenty.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.stats.finite import finite
from analysis.stats.sign_test import SignTest, sign_test
from analysis.stats.wilcoxon import SignedRank, signed_rank

IGNORED: Final = (
    "that one participant's answers resemble each other",
    "that answers about one segment resemble each other",
    "that several tests are made",
)
"""What both tests ignore."""

TIES_IGNORED: Final = "answers 'no difference'"
"""What both leave out besides."""


@dataclass(frozen=True, kw_only=True)
class Pooled:
    """What pooled answers would say.

    Attributes
    ----------
    binomial : SignTest
        Wins against losses, whatever their strength.
    wilcoxon : SignedRank
        Signed ranks of all answers.
    first_percent, second_percent : float
        Preferences for the first and for the second condition, in percent of all answers: what
        AMUSE prints; NaN without answers.
    first_percent_of_decided : float
        Preferences for the first in percent of those for either; NaN without any.
    ignores : tuple of str
        What these numbers leave out of account, as ends of a sentence.
    """

    binomial: SignTest
    wilcoxon: SignedRank
    first_percent: float
    second_percent: float
    first_percent_of_decided: float
    ignores: tuple[str, ...]


def pooled_tests(towards_first: NDArray[np.number]) -> Pooled:
    """Compute what papers would report of one comparison and question.

    Parameters
    ----------
    towards_first : ndarray, shape (N,)
        Answers, turned so that they count from -2 (clearly the second condition) over 0 (no
        difference) to 2 (clearly the first).
    """
    answers = finite(towards_first)
    signs, count = sign_test(answers), len(answers)
    return Pooled(
        binomial=signs,
        wilcoxon=signed_rank(answers),
        first_percent=100 * signs.above / count if count else math.nan,
        second_percent=100 * signs.below / count if count else math.nan,
        first_percent_of_decided=100 * signs.estimate,
        ignores=(*IGNORED, TIES_IGNORED),
    )
