from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studyapp.rehearsal.simulation.population import (
    Kind,
    Population,
    default_population,
    ranks,
    rating_thresholds,
    step,
)
from studyapp.rehearsal.simulation.raters import Rater
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.questions import RatingQuestion
from studyapp.study.settings.rehearsal import Rehearsal


def test_unknown_conditions_are_ordered_by_the_file(study: PairwiseStudy) -> None:
    brought = {f"mine{index}": study.conditions["brought"] for index in range(5)}
    conditions = {"rule_based": study.conditions["rule_based"], **brought}
    quality = default_population(study.model_copy(update={"conditions": conditions})).quality
    assert [quality[name]["rhythm"] for name in brought] == [0.75, 0.5, 0.25, 0.0, 0.0]


def test_a_condition_of_another_name_is_as_good_as_its_generator(study: PairwiseStudy) -> None:
    conditions = {**study.conditions, "frozen": study.conditions["static"]}
    quality = default_population(study.model_copy(update={"conditions": conditions})).quality
    assert quality["frozen"] == quality["static"]


def test_what_the_study_states_takes_the_place_of_what_is_guessed(study: PairwiseStudy) -> None:
    stated = Rehearsal.model_validate(
        {
            "careless": 0.2,
            "hasty": 0,
            "segments_differ": 0.1,
            "strength": {"rule_based": 2, "static": {"emotion": -0.25}},
            "own_speech": {"rule_based": {"rhythm": 0.4}},
        }
    )
    people = default_population(study.model_copy(update={"rehearsal": stated}))
    assert people.quality["rule_based"] == {"rhythm": 2, "emotion": 2}
    assert people.quality["static"] == {"rhythm": -1.0, "emotion": -0.25}
    assert people.quality["mismatched"] == default_population(study).quality["mismatched"]
    assert people.belonging["rule_based"] == {"rhythm": 0.4, "emotion": 3.0}
    assert (people.kinds["careless"], people.kinds["hasty"], people.item_sd) == (0.2, 0.0, 0.1)


def test_raters_are_of_each_kind_as_often_as_stated(population: Population) -> None:
    shares: dict[Kind, float] = {
        "hasty": 0.2,
        "side_biased": 0.1,
        "returning": 0.3,
        "careless": 0.15,
    }
    people = replace(population, kinds=shares)
    kinds = Counter(Rater(population=people, seed=4, name=str(n)).kind for n in range(3000))
    assert kinds["attentive"] / 3000 == pytest.approx(0.25, abs=0.03)
    for kind, share in shares.items():
        assert kinds[kind] / 3000 == pytest.approx(share, abs=0.03)
    assert set(kinds) == {*shares, "attentive"}


POPULATION = Population(quality={})
UTILITIES = st.lists(st.floats(-9, 9), min_size=2, max_size=8)


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
