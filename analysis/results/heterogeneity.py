"""Whether an effect is the same for every emotion, segment and speaker, for `results.json`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal, TypeVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.table import AnswerTable
from analysis.results.grouping import (
    ConditionPlace,
    PairPlace,
    Place,
    codes,
    compared,
    parts,
    place_of,
)
from analysis.results.net_preference import sided
from analysis.stats.clustered_mean import UNTESTED, Estimate, clustered_mean
from analysis.stats.f_tests import FTest, between_groups, between_segments
from analysis.stats.multiple_testing import holm

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]
By = Literal["emotion", "speaker", "segment"]

KINDS: Final[tuple[By, ...]] = ("emotion", "speaker", "segment")


FEW: Final = 3
"""Segments up to which a cell is described and not tested."""


@dataclass(frozen=True, kw_only=True)
class Cell(Estimate):
    """The effect within one emotion, segment or speaker.

    Attributes
    ----------
    level : str
        Which one.
    descriptive : bool
        Whether it rests on so few segments that it is described and not tested: it says nothing
        about others of its kind, and `p_value` is NaN.
    p_holm : float
        `p_value`, corrected over all such tests of a report.
    """

    level: str
    descriptive: bool
    p_holm: float = math.nan


def cells(
    values: Floats,
    levels: Codes,
    names: Sequence[str],
    participants: Codes,
    segments: Codes,
    *,
    null: float,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> tuple[Cell, ...]:
    """Estimate an effect within each level that has answers.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One per answer; their mean is the effect.
    levels : ndarray of int, shape (N,)
        Which emotion, segment or speaker each is about, a place in `names`.
    names : sequence of str
        Of the levels.
    participants, segments : ndarray of int, shape (N,)
        Who answered about which segment.
    null : float
        The effect of none.
    limits : (float, float)
        Where values can lie.

    Returns
    -------
    tuple of Cell
        In the order of `names`.
    """
    order = np.argsort(levels, kind="stable")
    found, starts = np.unique(levels[order], return_index=True)
    return tuple(
        _cell(names[level], values[own], participants[own], segments[own], null, limits)
        for level, own in zip(found, np.split(order, starts[1:]), strict=True)
    )


def _cell(
    name: str,
    values: Floats,
    participants: Codes,
    segments: Codes,
    null: float,
    limits: tuple[float, float],
) -> Cell:
    mean = clustered_mean(values, participants, segments, null=null, limits=limits)
    count = mean.segments
    if descriptive := count <= FEW:
        untested = f"{count} segment{'s' * (count > 1)}: {UNTESTED}"
        remark = "; ".join(filter(None, (untested, mean.remark)))
        mean = replace(mean, p_value=math.nan, remark=remark)
    return Cell(**vars(mean), level=name, descriptive=descriptive)


@dataclass(frozen=True, kw_only=True)
class DifferenceTest(FTest):
    """Whether the levels differ at all; `p_holm` is corrected over all such tests of the report."""

    p_holm: float = math.nan


@dataclass(frozen=True, kw_only=True)
class Heterogeneity:
    """An effect by emotion, by speaker or by segment.

    Attributes
    ----------
    by : {'emotion', 'speaker', 'segment'}
        What tells the levels apart.
    measure : {'win_share', 'difference', 'mean_rank'}
        The effect: share of wins, difference of paired ratings in scores, or mean rank.
    null : float
        The effect of none.
    levels : tuple of Cell
        In the order of their names; those without answers are left out.
    test : DifferenceTest
        Whether they differ.
    """

    by: By
    measure: str
    null: float
    levels: tuple[Cell, ...]
    test: DifferenceTest


@dataclass(frozen=True, kw_only=True)
class PairHeterogeneity(Heterogeneity, PairPlace):
    """Of two conditions."""


@dataclass(frozen=True, kw_only=True)
class ConditionHeterogeneity(Heterogeneity, ConditionPlace):
    """Of one condition."""


AnyHeterogeneity = TypeVar("AnyHeterogeneity", bound=Heterogeneity)


def heterogeneity(
    place: Place,
    answers: pd.DataFrame,
    values: Floats,
    *,
    measure: str,
    null: float,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> Iterator[Any]:
    """Take an effect apart by emotion, speaker and segment, where there are several of them.

    Parameters
    ----------
    place : ConditionPlace or PairPlace
        What the effect is about; the results are of its kind.
    answers : DataFrame
        Main and repeated trials of one question, one row a value.
    values : ndarray, shape (N,)
        Their mean is the effect.
    measure, null : str, float
        See `Heterogeneity`.
    limits : (float, float)
        Where values can lie.
    """
    kind = PairHeterogeneity if isinstance(place, PairPlace) else ConditionHeterogeneity
    who, what = codes(answers, "participant"), codes(answers, "segment")
    for by in KINDS:
        level = codes(answers, by)
        known = level >= 0
        if len(np.unique(level[known])) < 2:
            continue
        part = values[known], level[known], who[known], what[known]
        found = cells(
            *part[:2],
            [str(name) for name in answers[by].cat.categories],
            *part[2:],
            null=null,
            limits=limits,
        )
        test = (
            between_segments(part[0], part[2], part[3])
            if by == "segment"
            else between_groups(*part)
        )
        yield kind(
            **vars(place),
            by=by,
            measure=measure,
            null=null,
            levels=tuple(sorted(found, key=lambda cell: cell.level)),
            test=DifferenceTest(**vars(test)),
        )


def preference_heterogeneity(table: AnswerTable, analysed: pd.DataFrame) -> list[Any]:
    """Take every win share apart: of a pair's a, or of a condition's own speech."""
    return [
        one
        for of, question, answers in parts(table, analysed)
        for numbers, rows in compared(answers)
        for one in heterogeneity(
            place_of(table, of, question, numbers),
            answers[rows],
            sided(answers[rows]).wins,
            measure="win_share",
            null=0.5,
            limits=(0.0, 1.0),
        )
    ]


def corrected_tests(found: Sequence[AnyHeterogeneity]) -> tuple[AnyHeterogeneity, ...]:
    """Return the results of a report, with Holm's correction of both kinds of tests."""
    tests = holm([one.test.p_value for one in found])
    # A cell that is only described is no member of the family.
    own = iter(holm([w.p_value for one in found for w in one.levels if not w.descriptive]))
    return tuple(
        replace(
            one,
            levels=tuple(w if w.descriptive else replace(w, p_holm=next(own)) for w in one.levels),
            test=replace(one.test, p_holm=p),
        )
        for one, p in zip(found, tests, strict=True)
    )
