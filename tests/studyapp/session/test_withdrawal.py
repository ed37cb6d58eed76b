from __future__ import annotations

from pathlib import Path

import pytest
from sqlalchemy import func, select

from studyapp.database.engine import Database
from studyapp.database.tables import (
    FormAnswer,
    RefusalLine,
    Response,
    Trial,
    TrialStimulus,
    Video,
    WatchRecord,
)
from studyapp.results.export.rows import form_answers_table
from studyapp.session.ending import withdrawal_promise
from studyapp.session.enrolment import Arrival
from studyapp.session.refusal import ConflictError, log_refusal
from studyapp.session.served_study import ServedStudy
from tests.studyapp.session.conftest import Open
from tests.support.read_once import read_once
from tests.support.studies.exported import responses_table
from tests.support.studies.form_questions import ADULT, ELIGIBILITY
from tests.support.studies.redefining import redefine
from tests.support.studies.taking_part_steps import Participant

ABOUT_THEM = (Trial, TrialStimulus, Video, WatchRecord, Response, FormAnswer, RefusalLine)
RECRUITED = Arrival(
    recruiter_participant="p1", recruiter_study="s1", recruiter_session="x1", form=ADULT
)


@pytest.fixture(params=["deleted"])
def begun(open_changed: Open, request: pytest.FixtureRequest) -> Participant:
    """Return a recruited participant of a study that promises something about withdrawal."""
    promise = ("[page]\n", f'[page]\nwithdrawn = "{request.param}"\n')
    return take_part(open_changed(promise, added=ELIGIBILITY), RECRUITED)


def take_part(participant: Participant, arrival: Arrival) -> Participant:
    """Let a participant answer a trial, and cause one refusal."""
    participant.arrive(arrival).begin().take_trial()
    refusal = ConflictError("No.", "Try again.")
    log_refusal(participant.database, participant.token, "answers", refusal, participant.clock)
    return participant


def counts(database: Database) -> list[int]:
    with database.reading() as session:
        return [session.scalars(select(func.count(table.id))).one() for table in ABOUT_THEM]


def test_promised_deletion_leaves_no_data(begun: Participant) -> None:
    database = begun.database
    before = counts(database)
    other = take_part(begun.another(), Arrival(visit="other", form=ADULT))

    begun.withdraw()

    assert counts(database) == before
    assert (begun.look().state, begun.look().presentations) == ("withdrawn", 0)
    left = begun.stored()
    assert left.withdrawn_at is not None
    assert (left.recruiter_participant, left.recruiter_session) == ("p1", "")
    assert (left.conditions, left.number, left.started_at) == ([], None, None)
    assert other.trial().position == 2
    assert len(read_once(database, responses_table)) == 2


@pytest.mark.parametrize("begun", ["kept"], indirect=True)
def test_kept_answers_are_stored_but_not_analysed(begun: Participant) -> None:
    database = begun.database
    before = counts(database)
    assert len(read_once(database, responses_table)) == 2

    begun.withdraw()

    assert counts(database) == before
    assert read_once(database, responses_table).empty
    assert read_once(database, form_answers_table).empty
    assert len(read_once(database, responses_table, withdrawn=True)) == 2
    assert len(read_once(database, form_answers_table, withdrawn=True)) == 1


def test_the_withdrawal_rule_at_consent_holds_after_the_study_changes_it(
    begun: Participant, tiny_study: Path
) -> None:
    redefine(tiny_study, ('withdrawn = "deleted"', 'withdrawn = "kept"'))
    begun.in_study(ServedStudy.read(tiny_study), new_version=True)

    assert withdrawal_promise(begun.database, begun.token) == "deleted"
    begun.withdraw()

    assert set(counts(begun.database)) == {0}
