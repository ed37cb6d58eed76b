from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from analysis.stats.agreement import krippendorff_alpha
from analysis.stats.f_tests import min_f
from analysis.stats.intraclass import intraclass_correlation
from analysis.stats.one_sample_tests import (
    equivalence_of_means,
    pooled_tests,
    sign_test,
    signed_rank,
)
from analysis.stats.ratings import cliffs_delta
from analysis.stats.samples import finite, levels, tied_ranks
from motion.errors import InputError

GAP = np.array([1.0, np.nan, 2.0, 1.0])
WHO, WHAT = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])


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
def test_a_missing_value_is_reported_and_never_becomes_a_number(
    statistic: Callable[[NDArray[np.float64]], object],
) -> None:
    with pytest.raises(InputError, match="value 2 of 4 is missing"):
        statistic(GAP)


def test_numbers_equal_but_for_rounding_are_tied() -> None:
    thirds = np.array([0.1 + 0.2, 0.3, 1 / 3, 1 - 2 / 3])
    assert levels(thirds).tolist() == [0, 0, 1, 1]
    assert tied_ranks(thirds).tolist() == [1.5, 1.5, 3.5, 3.5]
