from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

from analysis.validity.benchmark import EXPERIMENTS, Experiment, Row, main, measure, overall
from analysis.validity.realised import Realised, Tally
from analysis.validity.studies import Design

PAIRS, RATINGS, AGREED, VOTES, RANKINGS = EXPERIMENTS


SMALL = Design(participants=12, items=10, effect=0.0, participant_sd=1.0, item_sd=0.8)


def measured(experiment: Experiment, studies: int, design: Design = SMALL) -> dict[str, Row]:
    one = replace(experiment, designs=(design,), share=1.0)
    return {row.number: row for row in measure(one, studies=studies, seed=7)}


def test_clustered_tests_keep_their_level_where_pooled_ones_do_not() -> None:
    found = measured(PAIRS, studies=20, design=replace(SMALL, participants=20, items=16))

    for number in ("win share, two-way clustered", "clmm, likelihood ratio", "min F'"):
        assert found[number].realised.false_positives.value <= 0.2
        assert not found[number].naive
    for number in ("pooled binomial", "pooled Wilcoxon"):
        assert found[number].realised.false_positives.value >= 0.25
        assert found[number].naive
    for number in ("win share, two-way clustered", "clmm, Wald"):
        assert found[number].realised.coverage.value >= 0.8


def test_a_study_with_an_effect_finds_it_more_often_than_one_without() -> None:
    alike = replace(SMALL, items=24, participant_sd=0.0, item_sd=0.0)

    for row in measured(PAIRS, studies=10, design=alike).values():
        assert row.realised.power.value > row.realised.false_positives.value + 0.2


@pytest.mark.parametrize(
    ("experiment", "clustered", "naive"),
    [
        (VOTES, "Bradley-Terry, clustered by participant", "Bradley-Terry, errors of the model"),
        (RANKINGS, "Plackett-Luce, clustered by participant", "Friedman on all rankings"),
        (RATINGS, "rating difference, two-way clustered", "pooled Wilcoxon of ratings"),
    ],
)
def test_the_other_protocols_are_simulated_too(
    experiment: Experiment, clustered: str, naive: str
) -> None:
    found = measured(experiment, studies=4)

    assert found[naive].naive
    assert (
        found[clustered].realised.false_positives.value
        <= found[naive].realised.false_positives.value
    )
    assert found[clustered].realised.coverage.value > 0.5


def test_how_the_work_is_shared_out_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("analysis.validity.benchmark.BLOCK", 2)
    one = replace(VOTES, designs=(SMALL,))

    with ThreadPoolExecutor(2) as pool:
        shared = measure(one, studies=5, seed=1, pool=pool)

    assert repr(shared) == repr(measure(one, studies=5, seed=1))


def test_the_command_ends_with_names_and_values(capsys: pytest.CaptureFixture[str]) -> None:
    main(["--studies", "2", "--only", "votes", "--processes", "1"])

    *_, studies, seconds = capsys.readouterr().out.splitlines()
    assert studies == "studies: 2"
    assert seconds.startswith("seconds: ")


def test_a_number_fails_over_all_where_it_fails_in_one_design() -> None:
    rows = list(measured(VOTES, studies=1).values())[:1]
    fine = [replace(rows[0], realised=_realised(50)) for _ in range(2)]
    broken = replace(rows[0], realised=_realised(300))

    assert overall(fine) == "headline"
    assert overall([*fine, broken]) == "not a headline at 12 x 10, 1/0.8"


def _realised(significant: int) -> Realised:
    counted = Tally(studies=1000, tested=1000, significant=significant)
    return Realised.of(counted, counted)
