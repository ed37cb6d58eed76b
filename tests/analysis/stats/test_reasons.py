"""Where there is no number, a statistic says why; none of them fails."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from analysis.stats.agreement import krippendorff_alpha, retest_agreement
from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.f_tests import between_groups, between_segments, min_f
from analysis.stats.intraclass import intraclass_correlation
from analysis.stats.one_sample_tests import (
    equivalence,
    equivalence_of_means,
    sign_test,
    signed_rank,
)
from analysis.stats.rankings import Blocks, friedman
from analysis.stats.ratings import cliffs_delta, mean_difference, rated_cells
from analysis.stats.strength_models import bradley_terry
from tests.analysis.stats.named_votes import votes_of

NONE = np.nan
ALONE = "fewer than two participants with all conditions"
APART = "too few participants share items to tell them apart"
WHO, WHAT = (codes.ravel() for codes in np.indices((6, 8)))
GROUP, VALUES = WHAT % 4, np.random.default_rng(1).normal(size=48)


def cells(table: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return values, rows and columns of a table; NaN is missing."""
    values = np.asarray(table, np.float64)
    rows, columns = np.nonzero(~np.isnan(values))
    return values[rows, columns], rows, columns


def ranked(table: ArrayLike) -> Any:
    means = np.asarray(table, float)
    return friedman(Blocks(conditions=tuple("abcdef"[: means.shape[1]]), means=means))


def agreed(table: ArrayLike) -> Any:
    values, items, raters = cells(table)
    return intraclass_correlation(values, raters, items)


def again(first: ArrayLike, second: ArrayLike, people: ArrayLike) -> Any:
    return retest_agreement(*(np.array(part, int) for part in (first, second, people)))


def rated(values: ArrayLike, which: ArrayLike, people: ArrayLike, items: ArrayLike) -> Any:
    codes = (np.array(part, int) for part in (which, people, items))
    return mean_difference(rated_cells(np.array(values, float), *codes, count=2), 0, 1)


def dominant(values: ArrayLike, first: ArrayLike, people: ArrayLike) -> Any:
    y = np.array(values)
    return cliffs_delta(y, np.array(first, bool), np.array(people), np.arange(len(y)))


CASES: list[tuple[Callable[[], Any], str]] = [
    (lambda: ranked([[1], [2]]), "fewer than two conditions"),
    (lambda: ranked([[1, 2, 3]]), ALONE),
    (lambda: ranked(np.zeros((0, 3))), ALONE),
    (lambda: ranked([[2, 2], [1, 1]]), "nobody tells conditions apart"),
    (
        lambda: krippendorff_alpha(*cells(np.zeros((2, 0)))),
        "no item was answered about by two participants",
    ),
    (
        lambda: krippendorff_alpha(*cells([[1, NONE], [NONE, 2]])),
        "no item was answered about by two participants",
    ),
    (lambda: krippendorff_alpha(*cells([[3, 3], [3, 3]])), "all answers alike"),
    (lambda: krippendorff_alpha(*cells([[1], [2], [1]])), "one item gives no interval"),
    (lambda: again([], [], []), "no trial was answered again"),
    (lambda: again([1, 2], [1, 1], [0, 0]), "one participant gives no interval"),
    (lambda: again([0, 0], [0, 0], [0, 1]), "all answers alike"),
    (lambda: equivalence(NONE, 0.1, 0.3, df=5), "the difference is unknown"),
    (lambda: equivalence(0.1, NONE, 0.3, df=5), "the difference has no standard error"),
    (lambda: equivalence(0.1, 0.0, 0.3, df=5), "the difference has no standard error"),
    (lambda: equivalence(0.1, 0.1, 0.3, df=0), "the error has no degrees of freedom"),
    (lambda: equivalence_of_means(np.array([0.1]), 0.3), "fewer than two participants"),
    (lambda: equivalence_of_means(np.zeros(0), 0.3), "fewer than two participants"),
    (
        lambda: equivalence_of_means(np.array([0.1, 0.3 - 0.2, 0.1]), 0.3),
        "all participants differ alike",
    ),
    (lambda: agreed(np.zeros((0, 3))), "no answers"),
    (lambda: agreed([[1, 2, 3]]), "one item"),
    (lambda: agreed([[1], [2], [3]]), "one participant"),
    (lambda: agreed([[3, 3], [3, 3]]), "all answers alike"),
    (lambda: agreed([[1, NONE, 2], [NONE, 3, NONE]]), APART),
    (lambda: signed_rank(np.zeros(0)), "no values"),
    (lambda: signed_rank(np.zeros(3)), "all values are zero"),
    (lambda: sign_test(np.zeros(0)), "no values"),
    (lambda: sign_test(np.zeros(1)), "all values are zero"),
    (lambda: min_f(*cells([[1, 0, 1]])), "one participant"),
    (lambda: min_f(*cells([[1], [0]])), "one segment"),
    (lambda: min_f(*cells([[0, 0], [0, 0]])), "all answers are zero"),
    (lambda: min_f(*cells([[1, 1], [1, 1]])), "all answers alike"),
    (lambda: min_f(*cells(np.zeros((0, 2)))), "no answers"),
    (lambda: between_groups(VALUES, 0 * GROUP, WHO, WHAT), "fewer than two groups"),
    (
        lambda: between_groups(VALUES, GROUP, 0 * WHO, WHAT),
        "fewer than two participants answered about every group",
    ),
    (lambda: between_groups(VALUES, GROUP, WHO, GROUP), "one segment in every group"),
    (lambda: between_groups(0 * VALUES, GROUP, WHO, WHAT), "all answers alike"),
    (lambda: between_groups(VALUES[:0], GROUP[:0], WHO[:0], WHAT[:0]), "fewer than two groups"),
    (lambda: between_segments(VALUES, WHO, 0 * WHAT), "one segment"),
    (
        lambda: between_segments(VALUES, np.arange(48), WHAT),
        "too few participants share segments to tell them apart",
    ),
    (
        lambda: between_segments(WHO + WHAT.astype(float), WHO, WHAT),
        "participants differ alike in every segment",
    ),
    (
        lambda: between_segments(0 * VALUES, WHO, WHAT),
        "participants differ alike in every segment",
    ),
    (lambda: rated([], [], [], []), "no answers"),
    (lambda: rated([3, 4], [0, 0], [0, 1], [0, 1]), "one of the conditions has no ratings"),
    (lambda: rated([3, 4, 5, 2], [0, 1, 0, 1], [0] * 4, [0, 0, 1, 1]), "one participant"),
    (
        lambda: rated([3, 4, 2, 3], [0, 1, 0, 1], [0, 0, 1, 1], [0, 0, 1, 1]),
        "all pairs of ratings differ alike",
    ),
    (lambda: dominant([1, 2], [1, 1], [0, 1]), "one of the conditions has no ratings"),
    (lambda: dominant([1, 2, 2, 1], [1, 0, 1, 0], [0] * 4), "one participant"),
    (lambda: dominant([4, 5, 1, 2], [1, 1, 0, 0], [0, 1, 0, 1]), "the ratings do not overlap"),
    (lambda: dominant([3, 3, 3, 3], [1, 1, 0, 0], [0, 1, 0, 1]), "all ratings alike"),
    (lambda: clustered_mean(*cells([[1, 0, 0.5]])), "one participant"),
    (lambda: clustered_mean(*cells([[1, 1], [1, 1]])), "all answers alike"),
    (lambda: clustered_mean(*cells([[0.5, 0.5], [0.5, 0.5]])), "all answers alike"),
    (lambda: clustered_mean(*cells(np.zeros((0, 2)))), "no answers"),
]


@pytest.mark.parametrize(("statistic", "reason"), CASES)
def test_where_there_is_no_number_it_says_why(statistic: Callable[[], Any], reason: str) -> None:
    result = statistic()

    assert result.reason == reason
    numbers = [
        getattr(getattr(result, "single", result), name, NONE) for name in ("low", "p_value")
    ]
    assert all(math.isnan(number) for number in numbers)
    assert getattr(result, "verdict", "unknown") == "unknown"


@pytest.mark.parametrize(
    ("votes", "reason"),
    [
        (
            votes_of(["a", "c"], ["b", "d"], [1, 0], ["P"] * 2),
            "never compared with one another, not even through others: a and b | c and d",
        ),
        (votes_of(["a", "c"], ["b", "d"], [0, 0], ["P"] * 2), "all answers are ties"),
        (votes_of([], [], [], []), "no answers"),
    ],
)
def test_strengths_that_do_not_exist_have_a_reason(votes: Any, reason: str) -> None:
    result = bradley_terry(votes)

    assert reason in result.reason
    assert np.isnan(result.strengths).all()
