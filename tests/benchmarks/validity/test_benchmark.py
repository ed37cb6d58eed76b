from dataclasses import replace
from functools import cache

import pytest

from benchmarks.validity.benchmark import measure
from benchmarks.validity.experiments import EXPERIMENTS, Experiment
from benchmarks.validity.realised import Row
from benchmarks.validity.studies import Design

BY_NAME = {experiment.name: experiment for experiment in EXPERIMENTS}
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
