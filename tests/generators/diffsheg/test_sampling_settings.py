"""Settings of sampling that have a name, what differs from them, and the steps they take."""

from __future__ import annotations

import subprocess
import sys
from itertools import pairwise
from typing import Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from generators.diffsheg.settings import CLEAN, Sampling, SamplingSettings, evaluations


@pytest.mark.parametrize(
    ("preset", "asked"), [("smooth", 27), ("fast", 27), ("careful", 63), ("plain", 15)]
)
def test_a_named_setting_asks_the_network_as_often_as_it_says(
    preset: Literal["smooth", "fast", "careful", "plain"], asked: int
) -> None:
    assert evaluations(SamplingSettings(preset=preset).sampling(overlap=4).later_walk) == asked


def test_fast_and_careful_are_the_releases_and_smooth_is_taken_where_nothing_is_chosen() -> None:
    assert SamplingSettings(preset="fast").sampling(overlap=4) == Sampling()
    assert SamplingSettings(preset="careful").sampling(overlap=4) == Sampling(jump_count=5)
    smooth = Sampling(keeps_pose=True, own_noise=True, overlap=6)
    assert SamplingSettings().sampling(overlap=4) == smooth


def test_windows_share_the_releases_frames_and_half_as_many_more_where_they_are_to_be_smooth() -> (
    None
):
    assert SamplingSettings(preset="fast").sampling(overlap=10).overlap == 10
    assert SamplingSettings().sampling(overlap=10).overlap == 15
    assert SamplingSettings(overlap=4).sampling(overlap=10).overlap == 4


def test_what_is_chosen_takes_the_place_of_what_the_setting_has() -> None:
    chosen = SamplingSettings(preset="careful", steps=50, overlap=8, jump_length=5, blend_below=0.1)
    expected = Sampling(steps=50, overlap=8, entry=30, jump_length=5, jump_count=5, blend_below=0.1)
    assert chosen.sampling(overlap=4) == expected
    assert SamplingSettings(preset="careful", jump_count=3).sampling(overlap=4).jump_count == 3


@pytest.mark.parametrize(
    ("settings", "what"),
    [
        ({"preset": "hasty"}, "no sampling called 'hasty'"),
        ({"steps": 30}, "30 steps do not divide"),
        ({"entry": 26}, "entered 26 steps before the end of 25"),
        ({"overlap": -1}, "overlap -1"),
        ({"steps": 0}, "steps 0 is not possible"),
        ({"jump_count": 0}, "jump_count 0"),
        ({"blend_below": float("nan")}, "cannot be blended below a noise of nan"),
    ],
)
def test_what_cannot_be_sampled_is_refused(settings: dict[str, Any], what: str) -> None:
    with pytest.raises(ValidationError, match=what):
        SamplingSettings(**settings)


def test_settings_are_checked_without_loading_torch() -> None:
    code = "import generators.diffsheg.settings, sys; sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


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
