"""Whether an effect is the same for every emotion, segment and speaker, for `results.json`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.results.estimate import Estimate, estimate_of
from analysis.results.grouping import codes
from analysis.results.place import ConditionPlace, PairPlace
from analysis.stats.effect_cells import Cell, cells
from analysis.stats.heterogeneity import Between, between_groups, between_segments
from analysis.stats.holm import holm

Floats = NDArray[np.float64]
By = Literal["emotion", "speaker", "segment"]

KINDS: Final[tuple[By, ...]] = ("emotion", "speaker", "segment")


@dataclass(frozen=True, kw_only=True)
class Within(Estimate):
    """The effect within one emotion, speaker or segment.

    Attributes
    ----------
    level : str
        Which one.
    descriptive : bool
        Whether it rests on so few segments that it is described and not tested: it says nothing
        about others of its kind, and `p` is NaN.
    p_holm : float
        `p`, corrected over all such tests of the report.
    """

    level: str
    descriptive: bool
    p_holm: float = math.nan


@dataclass(frozen=True, kw_only=True)
class DifferenceTest:
    """Whether the levels differ at all.

    Attributes
    ----------
    f, df, df_rest, p : float
        F with its degrees of freedom.
    p_holm : float
        `p`, corrected over all such tests of the report.
    method, reason : str
        Which test; why there is none.
    """

    f: float
    df: float
    df_rest: float
    p: float
    p_holm: float = math.nan
    method: str
    reason: str


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
    levels : tuple of Within
        In the order of their names; those without answers are left out.
    test : DifferenceTest
        Whether they differ.
    """

    by: By
    measure: str
    null: float
    levels: tuple[Within, ...]
    test: DifferenceTest


@dataclass(frozen=True, kw_only=True)
class PairHeterogeneity(Heterogeneity, PairPlace):
    """Of two conditions."""


@dataclass(frozen=True, kw_only=True)
class ConditionHeterogeneity(Heterogeneity, ConditionPlace):
    """Of one condition."""


AnyHeterogeneity = TypeVar("AnyHeterogeneity", bound=Heterogeneity)


def heterogeneity(
    answers: pd.DataFrame,
    values: Floats,
    *,
    measure: str,
    null: float,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> Iterator[Heterogeneity]:
    """Take an effect apart by emotion, speaker and segment, where there are several of them.

    Parameters
    ----------
    answers : DataFrame
        Main and repeated trials of one question, one row a value.
    values : ndarray, shape (N,)
        Their mean is the effect.
    measure, null : str, float
        See `Heterogeneity`.
    limits : (float, float)
        Where values can lie.
    """
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
        yield Heterogeneity(
            by=by,
            measure=measure,
            null=null,
            levels=tuple(map(_within, sorted(found, key=lambda cell: cell.level))),
            test=_test(test),
        )


def corrected_tests(found: Sequence[AnyHeterogeneity]) -> tuple[AnyHeterogeneity, ...]:
    """Return the results of a report, with Holm's correction of both kinds of tests."""
    tests = holm([one.test.p for one in found])
    # A cell that is only described is no member of the family.
    own = iter(holm([w.p for one in found for w in one.levels if not w.descriptive]))
    return tuple(
        replace(
            one,
            levels=tuple(w if w.descriptive else replace(w, p_holm=next(own)) for w in one.levels),
            test=replace(one.test, p_holm=p),
        )
        for one, p in zip(found, tests, strict=True)
    )


def _within(cell: Cell) -> Within:
    count = cell.mean.segments
    untested = f"{count} segment{'s' * (count > 1)}: described, not tested"
    remark = "; ".join(filter(None, (untested * cell.descriptive, cell.mean.remark)))
    return Within(
        **vars(estimate_of(replace(cell.mean, remark=remark))),
        level=cell.level,
        descriptive=cell.descriptive,
    )


def _test(found: Between) -> DifferenceTest:
    return DifferenceTest(
        f=found.statistic,
        df=found.freedom,
        df_rest=found.freedom_rest,
        p=found.p_value,
        method=found.method,
        reason=found.reason,
    )
