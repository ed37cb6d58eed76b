from __future__ import annotations

import numpy as np
import pytest

from analysis.stats.equivalence import equivalence_of_means
from analysis.stats.intraclass import intraclass_correlation
from analysis.stats.krippendorff import krippendorff_alpha
from analysis.stats.min_f import min_f
from analysis.stats.ratings import cliffs_delta
from analysis.stats.sign_test import sign_test
from analysis.stats.values import finite, group_means, levels, tied_ranks
from analysis.stats.wilcoxon import pooled_tests, signed_rank
from motion.errors import InputError

GAP = np.array([1.0, np.nan, 2.0, 1.0])
WHO, WHAT = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])


def test_numbers_pass_as_floats():
    assert finite(np.array([1, 2])).dtype == np.float64
    assert finite(np.zeros((0, 3))).shape == (0, 3)


@pytest.mark.parametrize(
    "statistic",
    [
        finite,
        signed_rank,
        sign_test,
        pooled_tests,
        lambda values: min_f(values, WHO, WHAT),
        lambda values: equivalence_of_means(values, 0.3),
        lambda values: krippendorff_alpha(values, WHO, WHAT),
        lambda values: intraclass_correlation(values, WHO, WHAT),
        lambda values: cliffs_delta(values, WHAT == 0, WHO, WHAT),
    ],
)
def test_a_missing_value_is_named_and_never_becomes_a_number(statistic):
    with pytest.raises(InputError, match="value 2 of 4 is missing"):
        statistic(GAP)


def test_everybody_counts_once_however_many_answers():
    values, people = np.array([1.0, 0, 1, 1]), np.array(["b", "a", "b", "b"])
    assert group_means(values, people).tolist() == [0, 1]
    assert group_means(np.zeros(0), np.zeros(0, str)).tolist() == []


def test_numbers_equal_but_for_rounding_are_tied():
    thirds = np.array([0.1 + 0.2, 0.3, 1 / 3, 1 - 2 / 3])
    assert levels(thirds).tolist() == [0, 0, 1, 1]
    assert tied_ranks(thirds).tolist() == [1.5, 1.5, 3.5, 3.5]


def test_rows_are_ranked_apart():
    assert tied_ranks(np.array([[3.0, 1.0, 2.0], [5.0, 5.0, 9.0]])).tolist() == [
        [3, 1, 2],
        [1.5, 1.5, 3],
    ]


def test_nothing_has_no_ranks():
    assert tied_ranks(np.zeros(0)).tolist() == []
    assert tied_ranks(np.zeros(3)).tolist() == [2, 2, 2]
