from __future__ import annotations

import numpy as np

from analysis.stats.tied_ranks import levels, tied_ranks


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
