from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.rehearsal_recovery import Tally, measure, simulated, template_study
from studyapp.rehearsal.simulation.population import KINDS, Population, default_population
from tools.markdown import marks

DOCS = Path(__file__).resolve().parents[2] / "docs" / "rehearsal.md"


def test_tables_are_reproducible_and_the_page_has_every_question() -> None:
    first = measure(rehearsals=1)
    assert first == measure(rehearsals=1)
    begin, end = marks("measured")
    tables = DOCS.read_text("utf-8").split(begin)[1].split(end)[0]
    for question in template_study()[0].questions:
        assert f"| {question.name} | after exclusions |" in tables
    for kind in KINDS:
        assert f"| {kind.replace('_', ' ')} |" in tables


def test_places_are_refilled_until_somebody_finishes() -> None:
    study, segments = template_study()
    people = default_population(study)
    leaving = Population(quality=people.quality, kinds={"dropping_out": 0.4})
    made = simulated(study, segments, leaving, seed=1)
    whole = [who for who, known in made.known.items() if known.settled == known.trials]
    assert len(whole) == study.arms[0].places
    assert len(made.known) > len(whole)
    assert {made.kinds[who] for who in made.known if who not in whole} == {"dropping_out"}


@pytest.mark.parametrize(
    ("truth", "low", "high", "inside", "right", "wrong"),
    [(0.6, 0.55, 0.7, 1, 1, 0), (0.6, 0.3, 0.4, 0, 0, 1), (0.6, 0.45, 0.7, 1, 0, 0)],
)
def test_an_interval_without_one_half_finds_a_preference(
    truth: float, low: float, high: float, inside: int, right: int, wrong: int
) -> None:
    tally = Tally()
    tally.add(truth, (low + high) / 2, low, high)
    assert (tally.inside, tally.right, tally.wrong) == (inside, right, wrong)
