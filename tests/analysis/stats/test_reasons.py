"""Where there is no number, a statistic says why; none of them fails."""

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
from analysis.stats.one_sample_tests import equivalence
from analysis.stats.rankings import Blocks, friedman
from analysis.stats.ratings import cliffs_delta, mean_difference, rated_cells
from analysis.stats.samples import levels, tied_ranks
from analysis.stats.strength_models import bradley_terry
from tests.analysis.stats.tables import cells, votes_of

NONE = math.nan
UNSHARED = "no item was answered about by two participants"
DISTINCT = "too few participants share segments to tell them apart"
WHO, WHAT = (codes.ravel() for codes in np.indices((6, 8)))
GROUP, VALUES = WHAT % 4, np.random.default_rng(1).normal(size=48)


def ranked(table: ArrayLike) -> Any:
    means = np.asarray(table, float)
    return friedman(Blocks(conditions=tuple("abcdef"[: means.shape[1]]), means=means))


def rated(values: ArrayLike, which: ArrayLike, people: ArrayLike, items: ArrayLike) -> Any:
    codes = (np.array(part, int) for part in (which, people, items))
    return mean_difference(rated_cells(np.array(values, float), *codes, count=2), 0, 1)


def dominant(values: ArrayLike, first: ArrayLike, people: ArrayLike) -> Any:
    y = np.array(values)
    return cliffs_delta(y, np.array(first, bool), np.array(people), np.arange(len(y)))


CASES: list[tuple[Callable[[], Any], str]] = [
    (lambda: ranked([[1, 2, 3]]), "fewer than two participants with all conditions"),
    (lambda: ranked([[2, 2], [1, 1]]), "nobody tells conditions apart"),
    (lambda: krippendorff_alpha(*cells([[1, NONE], [NONE, 2]])), UNSHARED),
    (lambda: krippendorff_alpha(*cells([[3, 3], [3, 3]])), "all answers alike"),
    (lambda: krippendorff_alpha(*cells([[1], [2], [1]])), "one item gives no interval"),
    (lambda: retest_agreement(WHAT, WHAT[::-1], 0 * WHO), "one participant gives no interval"),
    (lambda: retest_agreement(0 * WHO, 0 * WHO, WHO), "all answers alike"),
    (lambda: equivalence(clustered_mean(*cells([[1, 0, 0.5]])), 0.3), "one participant"),
    (lambda: intraclass_correlation(VALUES, WHO, 0 * WHAT), "one item"),
    (lambda: intraclass_correlation(VALUES, 0 * WHO, WHAT), "one participant"),
    (lambda: min_f(*cells([[1, 0, 1]])), "one participant"),
    (lambda: min_f(*cells([[1], [0]])), "one segment"),
    (lambda: min_f(*cells([[1, 1], [1, 1]])), "all answers alike"),
    (
        lambda: between_groups(VALUES, GROUP, 0 * WHO, WHAT),
        "fewer than two participants answered about every group",
    ),
    (lambda: between_groups(VALUES, GROUP, WHO, GROUP), "one segment in every group"),
    (lambda: between_groups(0 * VALUES, GROUP, WHO, WHAT), "all answers alike"),
    (lambda: between_segments(VALUES, np.arange(48), WHAT), DISTINCT),
    (
        lambda: between_segments(WHO + WHAT.astype(float), WHO, WHAT),
        "participants differ alike in every segment",
    ),
    (lambda: rated([3, 4, 5, 2], [0, 1, 0, 1], [0] * 4, [0, 0, 1, 1]), "one participant"),
    (lambda: rated([3, 4, 5, 2], [0, 1, 0, 1], [0] * 4, range(4)), "one participant"),
    (
        lambda: rated([3, 4, 3, 4], [0, 1, 0, 1], range(4), range(4)),
        "all ratings of a condition alike",
    ),
    (
        lambda: rated([3, 4, 2, 3], [0, 1, 0, 1], [0, 0, 1, 1], [0, 0, 1, 1]),
        "all pairs of ratings differ by the same amount",
    ),
    (lambda: dominant([1, 2, 2, 1], [1, 0, 1, 0], [0] * 4), "one participant"),
    (lambda: dominant([4, 5, 1, 2], [1, 1, 0, 0], [0, 1, 0, 1]), "the ratings do not overlap"),
    (lambda: clustered_mean(*cells([[1, 0, 0.5]])), "one participant"),
    (lambda: clustered_mean(*cells([[0.5, 0.5], [0.5, 0.5]])), "all answers alike"),
    (lambda: clustered_mean(*cells(np.zeros((0, 2)))), "no answers"),
]


@pytest.mark.parametrize(("statistic", "reason"), CASES)
def test_a_missing_number_has_a_reason(statistic: Callable[[], Any], reason: str) -> None:
    result = statistic()

    assert result.reason == reason
    result = getattr(result, "single", result)
    assert all(math.isnan(getattr(result, name, NONE)) for name in ("low", "p_value"))
    assert getattr(result, "verdict", "unknown") == "unknown"


@pytest.mark.parametrize(
    ("outcomes", "reason"),
    [
        (
            [1, 0],
            "never compared with one another, not even through others: a and b | c and d; "
            "strengths have no common scale",
        ),
        ([0, 0], "all answers are ties"),
        ([], "no answers"),
    ],
)
def test_missing_strengths_have_a_reason(outcomes: list[int], reason: str) -> None:
    count = len(outcomes)
    result = bradley_terry(
        votes_of(["a", "c"][:count], ["b", "d"][:count], outcomes, ["P"] * count, conditions="abcd")
    )

    assert result.reason == reason
    assert np.isnan(result.strengths).all()


def test_numbers_equal_but_for_rounding_are_tied() -> None:
    thirds = np.array([0.1 + 0.2, 0.3, 1 / 3, 1 - 2 / 3])
    assert levels(thirds).tolist() == [0, 0, 1, 1]
    assert tied_ranks(thirds).tolist() == [1.5, 1.5, 3.5, 3.5]
