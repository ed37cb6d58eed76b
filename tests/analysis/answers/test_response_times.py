from __future__ import annotations

import math

import numpy as np

from analysis.answers.response_times import response_times

SECONDS = np.array([20.0, 30, 40, 20, 22, 24, 30, 30, np.nan, 2, 3, 30])
PEOPLE = list("aaabbbcccddd")


def test_medians_are_those_of_participants_not_of_answers() -> None:
    found = response_times(SECONDS, PEOPLE)
    assert (found.low_quartile, found.median, found.high_quartile) == (17.25, 26, 30)
    assert (found.n, found.missing) == (11, 1)


def test_half_the_typical_time_is_too_fast() -> None:
    found = response_times(SECONDS, PEOPLE)
    assert found.limit == 13
    assert found.too_fast == {"d": 3}


def test_no_times_give_a_reason() -> None:
    found = response_times(np.array([np.nan]), ["a"])
    assert (found.reason, found.missing, found.too_fast) == ("no response times", 1, {})
    assert math.isnan(found.median)
