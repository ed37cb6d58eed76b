from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from studyapp.definition.protocols.pairwise import PairwiseStudy
from studyapp.rehearsal.population import Population, default_population


def test_the_conditions_every_study_knows_are_ordered_as_expected(population: Population) -> None:
    rhythm = {name: quality["rhythm"] for name, quality in population.quality.items()}
    assert rhythm["rule_based"] > rhythm["mismatched"] > rhythm["static"] > rhythm["broken"]


def test_a_recording_beats_every_generator(study: PairwiseStudy) -> None:
    conditions = {**study.conditions, "ground_truth": study.conditions["brought"]}
    quality = default_population(study.model_copy(update={"conditions": conditions})).quality
    assert max(quality, key=lambda name: quality[name]["rhythm"]) == "ground_truth"


def test_unknown_conditions_are_ordered_by_the_file(study: PairwiseStudy) -> None:
    brought = {f"mine{index}": study.conditions["brought"] for index in range(5)}
    conditions = {"rule_based": study.conditions["rule_based"], **brought}
    quality = default_population(study.model_copy(update={"conditions": conditions})).quality
    assert [quality[name]["rhythm"] for name in brought] == [0.75, 0.5, 0.25, 0.0, 0.0]


def test_a_condition_of_another_name_is_as_good_as_its_generator(study: PairwiseStudy) -> None:
    conditions = {**study.conditions, "frozen": study.conditions["static"]}
    quality = default_population(study.model_copy(update={"conditions": conditions})).quality
    assert quality["frozen"] == quality["static"]


def test_questions_differ_in_how_far_they_tell_conditions_apart(population: Population) -> None:
    gaps = {
        question: population.quality["rule_based"][question]
        - population.quality["static"][question]
        for question in ("rhythm", "emotion")
    }
    assert 0 < gaps["emotion"] < gaps["rhythm"]


def test_only_motion_that_is_better_than_mismatched_suits_its_own_speech_better(
    population: Population,
) -> None:
    belonging = {name: belongs["rhythm"] for name, belongs in population.belonging.items()}
    assert belonging["brought"] > belonging["rule_based"] > 0
    assert belonging["mismatched"] == belonging["static"] == belonging["broken"] == 0


@pytest.mark.parametrize(
    "change",
    [
        {"weak": 0.0},
        {"weak": 3.0},
        {"participant_sd": -0.1},
        {"item_sd": -0.1},
        {"side_bias_sd": -0.1},
        {"leniency_sd": -0.1},
        {"rating_spread": 0.0},
        {"inattentive": 1.1},
        {"overlooked": -0.1},
        {"reasons": 2.0},
    ],
)
def test_an_impossible_population_is_refused(
    population: Population, change: dict[str, Any]
) -> None:
    with pytest.raises(ValueError, match=r"thresholds|negative|share|above 0"):
        replace(population, **change)
