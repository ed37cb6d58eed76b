from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.scales import (
    preference_thresholds,
    ranks,
    rating_thresholds,
    step,
)
from studyapp.study.settings.scales import RatingQuestion

POPULATION = Population(quality={})
UTILITIES = st.lists(st.floats(-9, 9), min_size=2, max_size=8)


@pytest.mark.parametrize("levels", [2, 3, 5])
def test_a_preference_scale_is_symmetric_and_has_one_border_fewer_than_answers(levels: int) -> None:
    borders = preference_thresholds(POPULATION, levels)
    assert len(borders) == levels - 1
    assert borders == tuple(-border for border in reversed(borders))


@pytest.mark.parametrize("levels", [5, 101])
def test_a_rating_of_nothing_special_is_the_middle_of_the_scale(levels: int) -> None:
    values = range(levels)
    assert step(values, rating_thresholds(POPULATION, levels), 0.0) == levels // 2


@given(latent=st.floats(-12, 12))
def test_a_slider_is_moved_into_the_band_whose_label_would_have_been_chosen(latent: float) -> None:
    slider = RatingQuestion(name="q", title="Q", text="?", scale="slider")
    number = step(slider.values, rating_thresholds(POPULATION, len(slider.values)), latent)
    label = step(range(1, 6), rating_thresholds(POPULATION, 5), latent)
    # The slider has 101 numbers, of which the last belongs to no band of twenty.
    assert slider.step(number) - label in {0, 1}
    assert slider.step(max(0, number - 1)) <= label


@given(utilities=UTILITIES)
def test_a_ranking_without_ties_is_an_order_from_the_best(utilities: list[float]) -> None:
    found = ranks(utilities)
    assert sorted(found) == list(range(1, len(utilities) + 1))
    assert found[int(np.argmax(utilities))] == 1


@given(utilities=UTILITIES, within=st.floats(0, 5))
def test_shared_ranks_leave_no_rank_out_and_keep_the_order(
    utilities: list[float], within: float
) -> None:
    found = ranks(utilities, tie_within=within)
    assert set(found) == set(range(1, max(found) + 1))
    for a, b in zip(utilities, found, strict=True):
        for c, d in zip(utilities, found, strict=True):
            assert (a <= c) or b <= d
            assert b != d or abs(a - c) <= within


def test_what_is_put_first_on_demand_shares_its_rank_with_nothing() -> None:
    assert ranks([0.1, float("inf"), 0.2, 3.0], tie_within=0.3) == (3, 1, 3, 2)
