"""Tests that take every single answer for an independent one.

Where participants or segments differ, they find effects that are not there: with standard
deviations of .6 and .45 logits, 22 participants and 24 segments three times in ten instead of
once in twenty.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.stats.sign_test import sign_test
from analysis.stats.values import finite
from analysis.stats.wilcoxon import signed_rank

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
    """What papers report: all answers taken as independent.

    Attributes
    ----------
    binomial_p : float
        Wins against losses, whatever their strength, by the sign test.
    wilcoxon_p : float
        Signed ranks of all answers.
    ignores : tuple of str
        What these numbers leave out of account, as ends of a sentence.
    reason : str
        Why there are none; empty where there are.
    """

    binomial_p: float
    wilcoxon_p: float
    ignores: tuple[str, ...]
    reason: str


def pooled_tests(towards_first: NDArray[np.number]) -> Pooled:
    """Compute what papers would report of one comparison and question.

    Parameters
    ----------
    towards_first : ndarray, shape (N,)
        Answers, turned so that they count from -2 (clearly the second condition) over 0 (no
        difference) to 2 (clearly the first).
    """
    answers = finite(towards_first)
    signs = sign_test(answers)
    return Pooled(
        binomial_p=signs.p_value,
        wilcoxon_p=signed_rank(answers).p_value,
        ignores=(*IGNORED, TIES_IGNORED),
        reason=signs.reason,
    )
