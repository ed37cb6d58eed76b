from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.record import Truth, read_truth, write_truth
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.truth import expectations
from studyapp.study.protocols.pairwise import PairwiseStudy
from tests.support.studies.made_study import make_segments


def test_the_truth_survives_its_file(
    study: PairwiseStudy, population: Population, tmp_path: Path
) -> None:
    truth = Truth(
        seed=1,
        study="0123",
        population=population,
        expected=expectations(
            study, make_segments(["anger", "fear"]), population=population, seed=1
        ),
    )
    write_truth(tmp_path / "rehearsal.json", truth)
    again = read_truth(tmp_path / "rehearsal.json")
    assert again == truth
    shares = {(entry.about, entry.question): entry.value for entry in again.expected}
    assert shares["rule_based-static", "rhythm"] == pytest.approx(0.77, abs=0.03)


@pytest.mark.parametrize("text", ["", "{}", '{"seed": 1, "population": {"weak": 9}}'])
def test_a_damaged_truth_is_named(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rehearsal.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"rehearsal\.json"):
        read_truth(path)


@pytest.fixture
def ledger(tmp_path: Path) -> Ledger:
    return Ledger(tmp_path / "rehearsal" / "acknowledged.jsonl")


def test_everything_noted_is_read_again(ledger: Ledger) -> None:
    ledger.answered("p", "token", {("fit", None): -2, ("realism", 3): 1})
    ledger.left("p")
    ledger.returned("p")
    ledger.completed("p", "CODE")
    found = Ledger(ledger.path).read()
    assert found.answers == {("token", "fit", 0): -2, ("token", "realism", 3): 1}
    assert found.codes == {"p": "CODE"}
    assert (found.left["p"], found.returned["p"], found.away) == (1, 1, frozenset({"p"}))


def test_a_line_that_was_never_finished_spoils_no_other(ledger: Ledger) -> None:
    ledger.completed("p", "FIRST")
    with ledger.path.open("a") as file:
        file.write('{"participant": "q", "co')
    ledger.completed("r", "SECOND")
    assert ledger.read().codes == {"p": "FIRST", "r": "SECOND"}
