"""The steps through the noise."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from generators.diffsheg.walk import CLEAN, Sampling, evaluations
from motion.errors import InputError


@pytest.mark.parametrize(("jump_count", "asked"), [(1, 15), (2, 27), (5, 63)])
def test_a_continuing_window_asks_as_often_as_the_release_does(jump_count: int, asked: int) -> None:
    assert evaluations(Sampling(jump_count=jump_count).later_walk) == asked


def test_a_first_window_asks_once_for_every_step() -> None:
    assert evaluations(Sampling().first_walk) == 25


def test_steps_are_spread_over_the_thousand_of_the_training() -> None:
    assert Sampling().timesteps[:3] == (0, 40, 80)
    assert Sampling().timesteps[-1] == 960


@given(st.integers(1, 25), st.integers(1, 6), st.integers(1, 4), st.sampled_from((25, 50)))
def test_every_walk_goes_step_by_step_to_where_no_noise_is_left(
    entry: int, length: int, count: int, steps: int
) -> None:
    sampling = Sampling(steps=steps, entry=entry, jump_length=length, jump_count=count)
    walk = sampling.later_walk
    assert walk[0] == entry - 1
    assert walk[-1] == CLEAN
    assert CLEAN not in walk[:-1]
    assert max(walk) <= entry - 1
    assert all(abs(here - there) == 1 for here, there in pairwise(walk))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"steps": 30}, "30 steps do not divide"),
        ({"steps": 0}, "steps 0 is not possible"),
        ({"entry": 26}, "26 steps before the end"),
        ({"overlap": -1}, "overlap -1"),
        ({"jump_count": 0}, "jump_count 0"),
    ],
)
def test_sampling_that_cannot_be_is_refused(wrong: dict[str, int], said: str) -> None:
    with pytest.raises(InputError, match=said):
        Sampling(**wrong)
