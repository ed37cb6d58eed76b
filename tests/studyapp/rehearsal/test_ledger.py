from __future__ import annotations

from pathlib import Path

import pytest

from studyapp.rehearsal.ledger import Acknowledged, Ledger


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
    assert (found.left["p"], found.returned["p"], found.away) == (1, 1, {"p"})


def test_a_line_that_was_never_finished_spoils_no_other(ledger: Ledger) -> None:
    ledger.completed("p", "FIRST")
    with ledger.path.open("a") as file:
        file.write('{"participant": "q", "co')
    ledger.completed("r", "SECOND")
    assert ledger.read().codes == {"p": "FIRST", "r": "SECOND"}


def test_nothing_is_known_before_anything_was_noted(ledger: Ledger) -> None:
    assert ledger.read() == Acknowledged()
    ledger.remove()
    ledger.completed("p", "CODE")
    ledger.remove()
    assert ledger.read() == Acknowledged()
