from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import func, select

from studyapp.database.engine import Database
from studyapp.database.tables import (
    FormAnswer,
    RefusalLine,
    Response,
    StudySession,
    Trial,
    TrialStimulus,
    Video,
    WatchRecord,
)
from studyapp.database.tables.base import Base
from studyapp.results.export.rows import form_answers_table
from studyapp.session.arrivals import Arrival
from studyapp.session.ending import promise_made, withdraw
from studyapp.session.enrolment import enrol
from studyapp.session.refusal import ConflictError
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from tests.functional.redefining import redefine
from tests.studyapp.exported import responses_table, study_sessions_table
from tests.studyapp.read_once import read_once
from tests.studyapp.session.test_form_answers import ADULT, FORM
from tests.studyapp.taking_part_steps import Participant, SetClock

ABOUT_THEM: tuple[type[Base], ...] = (
    Trial,
    TrialStimulus,
    Video,
    WatchRecord,
    Response,
    FormAnswer,
    RefusalLine,
)


def begun(
    folder: Path, database: Database, clock: SetClock, keys: str = "", more: str = ""
) -> Participant:
    """Return a recruited participant who has answered one trial."""
    redefine(folder, ("[page]\n", f"[page]\n{keys}\n"), added=more)
    served = ServedStudy.read(folder)
    open_study(database, served, clock)
    participant = Participant(database, served, clock)
    arrival = recruited(ADULT if more else {})
    participant.token = enrol(database, served, arrival, clock)
    return participant


def recruited(form: dict[str, str]) -> Arrival:
    return Arrival(
        recruiter_participant="p1", recruiter_study="s1", recruiter_session="x1", form=form
    )


def counts(database: Database) -> dict[str, int]:
    with database.reading() as session:
        return {
            table.__name__: session.scalars(select(func.count()).select_from(table)).one()
            for table in ABOUT_THEM
        }


def take_back(participant: Participant) -> None:
    withdraw(participant.database, participant.token, participant.clock)


def test_where_deletion_was_promised_nothing_they_did_is_left(
    tiny_study: Path, database: Database, clock: SetClock
) -> None:
    participant = begun(tiny_study, database, clock)
    participant.begin().take_trial()
    before = counts(database)
    other = Participant(database, participant.served, clock).enrol("other").begin()
    other.take_trial()

    take_back(participant)

    assert counts(database) == before
    assert participant.look().state == "withdrawn"
    assert participant.look().presentations == 0
    with database.reading() as session:
        left = session.scalars(
            select(StudySession).where(StudySession.token == participant.token)
        ).one()
        assert left.withdrawn_at is not None
        assert (left.recruiter_participant, left.recruiter_session) == ("p1", "")
        assert (left.conditions, left.number, left.started_at) == ([], None, None)
    assert other.trial().position == 2
    assert len(read_once(database, responses_table)) == 2


def test_who_withdrew_is_not_enrolled_again(
    tiny_study: Path, database: Database, clock: SetClock
) -> None:
    participant = begun(tiny_study, database, clock)
    take_back(participant)

    known = replace(recruited({}), token=participant.token)
    again = enrol(database, participant.served, known, clock)

    assert again == participant.token
    assert read_once(database, study_sessions_table)["state"].tolist() == ["withdrawn"]


def test_what_they_said_about_themselves_is_deleted_too(
    tiny_study: Path, database: Database, clock: SetClock
) -> None:
    participant = begun(tiny_study, database, clock, more=FORM)
    assert counts(database)["FormAnswer"] == 1

    take_back(participant)

    assert set(counts(database).values()) == {0}


def test_where_keeping_was_promised_all_is_kept_and_nothing_analysed(
    tiny_study: Path, database: Database, clock: SetClock
) -> None:
    participant = begun(
        tiny_study, database, clock, 'withdrawn = "kept"', FORM.split("[[form.d")[0]
    )
    participant.begin().take_trial()
    before = counts(database)
    assert len(read_once(database, responses_table)) == 2

    take_back(participant)

    assert counts(database) == before
    assert read_once(database, responses_table).empty
    assert read_once(database, form_answers_table).empty
    assert len(read_once(database, responses_table, withdrawn=True)) == 2
    assert len(read_once(database, form_answers_table, withdrawn=True)) == 1
    assert participant.look().presentations == 6


def test_what_was_promised_at_the_start_holds_when_the_study_promises_otherwise_now(
    tiny_study: Path, database: Database, clock: SetClock
) -> None:
    participant = begun(tiny_study, database, clock)
    participant.begin().take_trial()
    redefine(tiny_study, ("[page]\n", '[page]\nwithdrawn = "kept"\n'))
    open_study(database, ServedStudy.read(tiny_study), clock, new_version=True)

    assert promise_made(database, participant.token) == "deleted"
    take_back(participant)

    assert set(counts(database).values()) == {0}


def test_withdrawing_twice_changes_nothing(participant: Participant) -> None:
    take_back(participant)
    withdrawn = read_once(participant.database, study_sessions_table)
    participant.clock.advance(minutes=5)

    take_back(participant)

    assert read_once(participant.database, study_sessions_table).equals(withdrawn)


def test_the_place_of_who_withdrew_is_open_again(participant: Participant) -> None:
    for number in range(3):
        Participant(participant.database, participant.served, participant.clock).enrol(f"{number}")

    take_back(participant)

    enrol(participant.database, participant.served, Arrival(visit="new"), participant.clock)


def test_who_has_finished_is_told_whom_to_ask(participant: Participant) -> None:
    participant.take_all()

    with pytest.raises(ConflictError, match="write to the people"):
        promise_made(participant.database, participant.token)
