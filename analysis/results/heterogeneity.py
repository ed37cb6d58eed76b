"""Whether an effect is the same for every emotion, segment and speaker, for `results.json`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal, TypeVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.results.grouping import ConditionPlace, PairPlace, Place, codes
from analysis.stats.heterogeneity import Cell, between_groups, between_segments, cells
from analysis.stats.holm import holm
from analysis.stats.min_f import FTest

Floats = NDArray[np.float64]
By = Literal["emotion", "speaker", "segment"]

KINDS: Final[tuple[By, ...]] = ("emotion", "speaker", "segment")


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
