"""How often the reference wins: per comparison, question and, if asked for, emotion.

The win share of a condition is its share of the answers with a preference for it, an answer 'no
difference' counting one half for each side; .5 means that neither is preferred.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from analysis.preferences.clustered import ClusteredMean, clustered_mean
from analysis.preferences.counts import FiveLevelCounts, count_levels, towards_reference


@dataclass(frozen=True, kw_only=True)
class Preference:
    """What the answers to one question of one comparison say.

    Attributes
    ----------
    comparison, reference, other, question : str
        What was compared, and the question asked.
    emotion : str
        The emotion that the answers are restricted to; empty for all of them.
    counts : FiveLevelCounts
        Answers per level, seen from the reference.
    win_share : ClusteredMean
        Win share of the reference, tested against .5.
    holm_p : float
        The test's p value after Holm's correction over the declared family; NaN where there is
        no test or no family.
    """

    comparison: str
    reference: str
    other: str
    question: str
    emotion: str = ""
    counts: FiveLevelCounts
    win_share: ClusteredMean
    holm_p: float = math.nan


def compare(
    analysed: pd.DataFrame,
    comparisons: Sequence[tuple[str, str, str]],
    questions: Sequence[str],
) -> tuple[Preference, ...]:
    """Estimate every comparison and question; together they are one family of tests.

    Parameters
    ----------
    analysed : DataFrame
        Tidy main and repeat answers.
    comparisons : sequence of (name, reference, other)
        Comparisons in the order wanted; one without answers gets an estimate that says so.
    questions : sequence of str
        Names of the questions in the order wanted.

    Returns
    -------
    tuple of Preference
        Comparisons outermost, with Holm-corrected p values over all of them.
    """
    found = _preferences(analysed, comparisons, questions)
    corrected = holm([preference.win_share.p_value for preference in found])
    return tuple(replace(p, holm_p=q) for p, q in zip(found, corrected, strict=True))


def compare_by_emotion(
    analysed: pd.DataFrame,
    comparisons: Sequence[tuple[str, str, str]],
    questions: Sequence[str],
) -> tuple[Preference, ...]:
    """Estimate every comparison and question within each emotion; no test belongs to a family."""
    return tuple(
        replace(preference, emotion=str(emotion))
        for emotion, answers in analysed.groupby("emotion")
        for preference in _preferences(answers, comparisons, questions)
    )


def holm(p_values: Sequence[float]) -> tuple[float, ...]:
    """Correct a declared family of p values by Holm's (1979) step-down method.

    A test that could not be made (NaN) still counts as a member of the family, so that a missing
    result never makes the others look more certain; its own corrected value is NaN.
    """
    family = np.asarray(p_values, float)
    if not family.size:
        return ()
    missing = np.isnan(family)
    tested = np.where(missing, 1.0, family)
    order = np.argsort(tested, kind="stable")
    steps = np.maximum.accumulate(tested[order] * np.arange(len(family), 0, -1))
    corrected = np.empty_like(tested)
    corrected[order] = np.minimum(1.0, steps)
    return tuple(float(p) for p in np.where(missing, math.nan, corrected))


def _preferences(
    analysed: pd.DataFrame,
    comparisons: Sequence[tuple[str, str, str]],
    questions: Sequence[str],
) -> list[Preference]:
    return [
        _preference(
            analysed[(analysed["comparison"] == pair[0]) & (analysed["question"] == question)],
            pair,
            question,
        )
        for pair in comparisons
        for question in questions
    ]


def _preference(answers: pd.DataFrame, pair: tuple[str, str, str], question: str) -> Preference:
    oriented = towards_reference(answers)
    comparison, reference, other = pair
    return Preference(
        comparison=comparison,
        reference=reference,
        other=other,
        question=question,
        counts=count_levels(oriented),
        win_share=clustered_mean(
            (np.sign(oriented) + 1) / 2,
            answers["study_session"].to_numpy(str),
            answers["segment"].to_numpy(str),
        ),
    )
