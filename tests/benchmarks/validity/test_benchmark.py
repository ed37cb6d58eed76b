from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks.validity.benchmark import measure
from benchmarks.validity.experiments import EXPERIMENTS, Experiment
from benchmarks.validity.realised import Realised, Row, Tally, overall
from benchmarks.validity.studies import (
    Design,
    judgements,
    preferences,
    ratings,
    true_mean_rating,
    true_rating_difference,
    true_win_share,
)

BY_NAME = {experiment.name: experiment for experiment in EXPERIMENTS}
VOTES = BY_NAME["votes"]


SMALL = Design(participants=12, items=10, effect=0.0, participant_sd=1.0, item_sd=0.8)


def measured(experiment: Experiment, studies: int, design: Design = SMALL) -> dict[str, Row]:
    small_experiment = replace(experiment, designs=(design,), share=1.0)
    return {row.number: row for row in measure(small_experiment, studies=studies, seed=7)}


@cache
def few_studies(name: str) -> dict[str, Row]:
    return measured(BY_NAME[name], studies=15)


def test_clustered_tests_keep_their_level_where_pooled_ones_do_not() -> None:
    found = measured(BY_NAME["pairs"], studies=60, design=replace(SMALL, participants=20, items=16))

    for number in ("win share, two-way clustered", "min F'"):
        assert found[number].realised.false_positives.value <= 0.15
        assert not found[number].naive
    for number in ("pooled binomial", "pooled Wilcoxon"):
        assert found[number].realised.false_positives.value >= 0.25
        assert found[number].naive
    assert found["win share, two-way clustered"].realised.coverage.value >= 0.85


@pytest.mark.parametrize(
    ("name", "clustered", "naive"),
    [
        ("votes", "Bradley-Terry strength, two-way", "Bradley-Terry strength, errors of the model"),
        ("votes", "Bradley-Terry ranks", "Bradley-Terry strength, clustered by participant"),
        ("rankings", "Plackett-Luce worth, two-way", "Plackett-Luce worth, errors of the model"),
        ("rankings", "mean rank", "Friedman on all rankings"),
        ("ratings", "difference of paired ratings", "pooled Wilcoxon of ratings"),
    ],
)
def test_two_way_clustering_lowers_false_positives(name: str, clustered: str, naive: str) -> None:
    found = few_studies(name)

    [ours] = (row.realised for number, row in found.items() if number.startswith(clustered))
    assert ours.false_positives.value < found[naive].realised.false_positives.value
    assert ours.coverage.value > 0.7


def test_conditions_that_differ_by_the_margin_are_rarely_called_equivalent() -> None:
    large = replace(SMALL, participants=25, items=24, participant_sd=0.3, item_sd=0.3)

    [row] = measured(BY_NAME["pairs, equivalence"], studies=100, design=large).values()

    assert row.realised.false_positives.value < 0.12
    assert row.realised.power.value > 0.5


def realised(significant: int, covered: int) -> Realised:
    without = Tally(studies=1000, tested=1000, significant=significant)
    with_effect = Tally(studies=1000, tested=1000, bounded=1000, covered=covered)
    return Realised.of(without, with_effect)


@pytest.mark.parametrize(
    ("significant", "covered", "verdict"),
    [
        (50, 950, "headline"),
        (29, 950, "conservative"),
        (300, 950, "not a headline"),
        (50, 700, "not a headline"),
        (66, 950, "not a headline (within error)"),
        (50, 929, "not a headline (within error)"),
        (300, 929, "not a headline"),
        (65, 930, "headline"),
    ],
)
def test_the_verdict_respects_its_limits(significant: int, covered: int, verdict: str) -> None:
    assert realised(significant, covered).verdict == verdict


def test_a_number_that_fails_in_one_design_fails_overall() -> None:
    row, *_ = measured(VOTES, studies=1).values()
    fine, broken = (replace(row, realised=realised(count, 950)) for count in (50, 300))

    assert overall([fine, fine]) == "headline"
    assert overall([fine, broken]) == "not a headline at 12 x 10, 1/0.8"


LARGE = Design(participants=700, items=700, effect=0.8, participant_sd=0.6, item_sd=0.45)
NOTHING = Design(participants=5, items=4, effect=0.0, participant_sd=0.6, item_sd=0.45)


def test_the_true_win_share_is_the_limit_of_many_answers() -> None:
    answers = preferences(LARGE, np.random.default_rng(1))

    assert answers.wins.mean() == pytest.approx(true_win_share(LARGE), abs=0.01)
    assert true_win_share(NOTHING) == pytest.approx(0.5)


@pytest.mark.parametrize("tastes", [True, False])
def test_the_true_rating_difference_is_the_limit_of_many_ratings(tastes: bool) -> None:
    chance = np.random.default_rng(2)
    judged = judgements(LARGE, 2, chance, differ=tastes)

    rated = ratings(judged, LARGE, chance)

    assert rated.min() == 1
    assert rated.max() == 5
    truth = true_rating_difference(LARGE, tastes=tastes)
    assert (rated[:, 0] - rated[:, 1]).mean() == pytest.approx(truth, abs=0.05)
    assert rated[:, 0].mean() == pytest.approx(true_mean_rating(LARGE, tastes=tastes), abs=0.05)
