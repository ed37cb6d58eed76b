"""How far participants agree with themselves: practice trials against their repeats."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.retest import repeated_answers, retest_agreement
from analysis.results.grouping import codes


@dataclass(frozen=True, kw_only=True)
class TestRetest:
    """Agreement of practice trials with their repeats.

    Attributes
    ----------
    kappa, low, high : float
        Cohen's kappa with quadratic weights, and its 95 % interval over participants.
    equal_share, equal_low, equal_high : float
        Share of the same answers, and its interval.
    spearman : float
        Rank correlation.
    n, participants : int
        Trials answered twice, and by how many.
    method, reason : str
        How the intervals were found; why a number is missing.
    """

    __test__ = False  # Its name is not that of a class of tests.

    kappa: float
    low: float
    high: float
    equal_share: float
    equal_low: float
    equal_high: float
    spearman: float
    n: int
    participants: int
    method: str
    reason: str


def retest_of(
    answers: pd.DataFrame,
    values: NDArray[np.integer],
    shown: Mapping[str, NDArray[np.intp]],
) -> TestRetest:
    """Compare practice trials with their repeats.

    Parameters
    ----------
    answers : DataFrame
        Of one question, practice trials included, of those whom every rule kept.
    values : ndarray of int, shape (N,)
        The answers, counted towards a condition and not towards a side.
    shown : mapping of name to ndarray of int, shape (N,)
        What a trial and its repeat have in common besides the segment.
    """
    rows = pd.DataFrame(
        {
            "participant": codes(answers, "participant"),
            "segment": codes(answers, "segment"),
            "kind": answers["kind"].to_numpy(object),
            "value": values,
            **shown,
        }
    )
    pairs = repeated_answers(rows, ["segment", *shown])
    found = retest_agreement(
        pairs["first"].to_numpy(np.int64),
        pairs["again"].to_numpy(np.int64),
        pairs["participant"].to_numpy(),
    )
    return TestRetest(
        kappa=found.kappa,
        low=found.low,
        high=found.high,
        equal_share=found.equal_share,
        equal_low=found.equal_low,
        equal_high=found.equal_high,
        spearman=found.correlation,
        n=found.pairs,
        participants=found.participants,
        method=found.method,
        reason=found.reason,
    )
