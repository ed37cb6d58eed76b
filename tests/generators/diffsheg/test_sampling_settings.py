"""Named ways of sampling, and the steps they take."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from generators.diffsheg.config import CLEAN, SAMPLINGS, Sampling


@pytest.mark.parametrize(
    ("name", "asked"), [("smooth", 27), ("fast", 27), ("careful", 63), ("plain", 15)]
)
def test_a_named_sampling_asks_the_network_as_often_as_documented(name: str, asked: int) -> None:
    walk = SAMPLINGS[name].later_walk
    assert sum(there < here for here, there in pairwise(walk)) == asked


def test_steps_are_spread_over_the_thousand_of_the_training() -> None:
    assert Sampling().timesteps[:3] == (0, 40, 80)
    assert Sampling().timesteps[-1] == 960


@given(st.integers(1, 4), st.sampled_from([1, 2, 5, 10, 25, 50]))
def test_every_walk_goes_step_by_step_to_where_no_noise_is_left(count: int, steps: int) -> None:
    sampling = Sampling(steps=steps, jump_count=count)
    walk = sampling.later_walk
    assert walk[0] == max(walk) == sampling.entry - 1 < steps
    assert walk[-1] == CLEAN
    assert CLEAN not in walk[:-1]
    assert all(abs(here - there) == 1 for here, there in pairwise(walk))
    assert sampling.first_walk == (*reversed(range(steps)), CLEAN)
