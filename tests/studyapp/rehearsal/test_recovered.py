"""What came of a small rehearsal is found in its database, and so is what went wrong in it."""

from contextlib import suppress
from dataclasses import replace

import pytest
from flask import Flask
from sqlalchemy import delete, select, update

from motion.errors import InputError
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Response
from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.participant import Departure, Participant
from studyapp.rehearsal.recovered import Recovery, recover
from studyapp.rehearsal.recovery_page import write_recovery
from studyapp.rehearsal.resumption import expire_leases, read_roster
from studyapp.rehearsal.simulation.truth import Truth, expectations, write_truth
from studyapp.study.folder import StudyFolder
from tests.studyapp.rehearsal.steps import browser
from tests.support.studies.stored import writing


def wrong(recovery: Recovery) -> list[str]:
    return [check.what for check in recovery.checks if not check.agrees]


def test_lost_or_changed_answers_are_detected(
    folder: StudyFolder, app: Flask, participant: Participant, eyes: Eyes
) -> None:
    with pytest.raises(InputError, match="has not been rehearsed"):
        recover(folder)
    people = replace(participant.population, kinds={"careless": 0.5, "dropping_out": 0.5})
    expected = expectations(folder.study(), folder.segments(), population=people, seed=1)
    truth = Truth(seed=participant.seed, study="", population=people, expected=expected)
    write_truth(folder.rehearsal_truth, truth)
    for number in range(4):
        person = replace(participant, name=f"rehearsal-{number:05d}", population=people)
        with browser(app) as client, suppress(Departure):
            person.take_part(client)
    expire_leases(eyes.database, read_roster(eyes.database, 4, truth), 45)
    recovery = recover(folder)
    assert wrong(recovery) == []
    came = {kind.kind: kind.came for kind in recovery.kinds}
    assert sum(came.values()) == 4
    left = {check.what: check.counted for check in recovery.checks}["left for good"]
    assert left == came.get("dropping_out", 0)
    page = write_recovery(folder, recovery)
    assert "Rehearsal: simulated raters" in page.read_text("utf-8")
    assert {path.suffix for path in folder.rehearsal_findings.iterdir()} == {".html", ".jsonl"}

    with writing(folder.rehearsal) as session:
        first, second = session.scalars(select(Response.id).order_by(Response.id)).all()[:2]
        session.execute(update(Response).where(Response.id == first).values(value=-2))
        session.execute(delete(Response).where(Response.id == second))
        session.execute(
            update(StudySession)
            .where(StudySession.completed_at.is_not(None))
            .values(completion_code=StudySession.completion_code + "x")
        )
    spoilt = wrong(recover(folder))
    assert "acknowledged answers, stored once and as they were given" in spoilt
    assert "were shown the code that is stored, each another one" in spoilt


def test_an_unfinished_line_among_acknowledgements_is_left_out(folder: StudyFolder) -> None:
    ledger = Ledger(folder.acknowledged)
    ledger.answered("p", "token", {("fit", None): -2, ("realism", 3): 1})
    with ledger.path.open("a") as file:
        file.write('{"participant": "q", "co')
    ledger.note("p", code="CODE")

    acknowledged = ledger.read()

    assert acknowledged.answers == {("token", "fit", 0): -2, ("token", "realism", 3): 1}
    assert acknowledged.codes == {"p": "CODE"}
