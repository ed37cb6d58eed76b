from __future__ import annotations

from math import comb

import pytest

from studyapp.rehearsal.recovery.words import chance_in_words, chance_of_missing


@pytest.mark.parametrize(("missed", "intervals"), [(1, 4), (2, 20), (5, 20)])
def test_the_chance_of_so_many_misses_is_that_of_a_binomial(missed: int, intervals: int) -> None:
    by_hand = 1 - sum(comb(intervals, k) * 0.05**k * 0.95 ** (intervals - k) for k in range(missed))
    assert chance_of_missing(missed, intervals) == pytest.approx(by_hand)


def test_one_miss_of_twenty_frightens_nobody() -> None:
    assert "1 or more of 20 intervals in 64 of 100 rehearsals" in chance_in_words(1, 20)


def test_so_many_misses_that_chance_hardly_explains_them_are_said_to_be() -> None:
    assert "fewer than 1 of 100" in chance_in_words(5, 20)


def test_no_miss_is_said_to_be_no_proof() -> None:
    assert chance_in_words(0, 4) == (
        "A sound design finds all of 4 intervals right in 81 of 100 rehearsals."
    )
    assert "no interval" in chance_in_words(0, 0)
