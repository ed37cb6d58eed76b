from __future__ import annotations

from itertools import combinations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from studyapp.study.design.adaptive import most_informative_pairs

NAMES = ("a", "b", "c", "d")
VOTES = st.dictionaries(
    st.sampled_from([(a, b) for a in NAMES for b in NAMES if a != b]), st.integers(0, 30)
)


def chance() -> np.random.Generator:
    return np.random.default_rng(1)


@given(VOTES, st.integers(0, 12))
def test_so_many_pairs_of_different_conditions_are_chosen(
    votes: dict[tuple[str, str], int], count: int
) -> None:
    pairs = most_informative_pairs(NAMES, votes, count, chance())

    assert len(pairs) == count
    assert set(pairs) <= set(combinations(NAMES, 2))


def test_without_votes_every_pair_comes_before_any_comes_again() -> None:
    pairs = most_informative_pairs(NAMES, {}, 3, chance())

    assert len(set(pairs)) == 3


def test_what_is_known_is_not_asked_again() -> None:
    votes = {("a", "b"): 20.0, ("b", "a"): 20.0}

    assert ("a", "b") not in most_informative_pairs(NAMES, votes, 4, chance())


def test_among_unequal_conditions_neighbours_are_worth_more_than_extremes() -> None:
    order = dict(zip(NAMES, (3, 2, 1, 0), strict=True))
    votes = {
        (a, b): 40.0 / (1 + np.exp(2 * (order[b] - order[a])))
        for a in NAMES
        for b in NAMES
        if a != b
    }

    assert ("a", "d") not in most_informative_pairs(NAMES, votes, 6, chance())
