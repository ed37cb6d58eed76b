from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.answers.response_times import response_times

SECONDS = np.array([20.0, 30, 40, 20, 22, 24, 30, 30, np.nan, 2, 3, 30])
PEOPLE = np.repeat(["a", "b", "c", "d"], 3)


def test_medians_are_those_of_participants_not_of_answers():
    found = response_times(SECONDS, PEOPLE)
    assert [p.median for p in found.participants] == [30, 22, 30, 3]
    assert found.median == 26
    assert (found.answers, found.missing) == (11, 1)


def test_half_the_typical_time_is_too_fast():
    found = response_times(SECONDS, PEOPLE)
    assert found.limit == 13
    assert found.too_fast == ("d",)
    assert found.participants[3].too_fast_share == pytest.approx(2 / 3)


def test_a_stated_limit_goes_before():
    found = response_times(SECONDS, PEOPLE, limit=25)
    assert found.too_fast == ("b", "d")
    assert found.method == "limit stated"


def test_no_times_give_a_reason():
    found = response_times(np.array([np.nan]), np.array(["a"]))
    assert (found.reason, found.missing, found.too_fast) == ("no response times", 1, ())
    assert math.isnan(found.median)
