from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.preferences.counts import count_levels, towards_reference
from analysis.responses import responses_frame
from motion.errors import InputError


def test_answers_are_turned_towards_the_reference_whatever_its_side(answer):
    left = [answer(position=k + 1, value=value) for k, value in enumerate((-2, -1, 0, 1, 2))]
    right = [
        row | {"left_condition": "other", "right_condition": "ours", "position": 10 + k}
        for k, row in enumerate(left)
    ]
    assert towards_reference(responses_frame(left)).tolist() == [2, 1, 0, -1, -2]
    assert towards_reference(responses_frame(right)).tolist() == [-2, -1, 0, 1, 2]


def test_counts_and_table_a5_sums_worked_by_hand():
    counts = count_levels(np.array([2, 2, 2, 1, 1, 0, -1, -1, -1, -2]))
    assert counts.levels == (3, 2, 1, 3, 1)
    assert counts.total == 10
    assert (counts.ours, counts.indifferent, counts.others) == (50, 10, 40)


def test_without_answers_percentages_are_not_numbers():
    counts = count_levels(np.zeros(0, np.int64))
    assert counts.levels == (0, 0, 0, 0, 0)
    assert math.isnan(counts.ours)


@given(st.lists(st.integers(-2, 2), min_size=1))
def test_percentages_add_up_and_mirroring_swaps_the_sides(values):
    counts = count_levels(np.array(values))
    mirrored = count_levels(-np.array(values))
    assert sum(counts.percentages) == pytest.approx(100)
    assert mirrored.levels == counts.levels[::-1]
    assert mirrored.ours == pytest.approx(counts.others)


def test_catch_answers_without_the_reference_are_refused(answer):
    catch = responses_frame(
        [
            answer(
                kind="catch",
                other="broken",
                left_condition="ground_truth",
                right_condition="broken",
                expected="left",
            )
        ]
    )
    with pytest.raises(InputError, match="reference"):
        towards_reference(catch)
