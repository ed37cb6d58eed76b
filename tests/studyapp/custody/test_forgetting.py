import re
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import String, Text, func, select

from motion.errors import InputError
from studyapp.custody import forgetting
from studyapp.custody.forgetting import FREE_TEXTS, find_data, forget
from studyapp.database import scrubbing
from studyapp.database.engine import Database
from studyapp.database.scrubbing import scrub
from studyapp.database.tables.base import Base
from studyapp.database.tables.researchers import AuditLine, Event, InterimFigures, Look
from studyapp.database.tables.study_session import Place, StudySession
from studyapp.recruitment.invitations import make_invitations
from studyapp.researchers.audit import (
    StudyState,
    detail_label,
    latest_changes,
    log_change,
    log_look,
)
from studyapp.researchers.credentials import token_hash
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.export.rows import form_answers_table
from studyapp.session.enrolment import Arrival
from studyapp.session.form_answers import note_screen_out
from studyapp.session.intake import change_intake
from studyapp.session.refusal import ConflictError, UnknownAddressError, log_refusal
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from tests.support.read_once import read_once
from tests.support.servers.both_databases import BOTH
from tests.support.servers.throwaway_postgresql import ThrowawayPostgresql
from tests.support.studies.exported import responses_table, study_sessions_table
from tests.support.studies.form_questions import ADULT, ELIGIBILITY
from tests.support.studies.redefining import redefine
from tests.support.studies.taking_part_steps import Participant, SetClock

PERSON = "5f3c1d9e7a2b4c6d8e0f1a2b"
SITTING = "sitting-of-this-person"
KEY = PseudonymKey(bytes(range(32)))


@pytest.fixture
def folder(tiny_study: Path) -> Path:
    redefine(tiny_study, added=ELIGIBILITY)
    return tiny_study


@pytest.fixture
def person(folder: Path, database: Database, clock: SetClock) -> Participant:
    """Return a recruited participant who has answered a trial and a form."""
    served = ServedStudy.read(folder)
    open_study(database, served, clock)
    return arrive(Participant(database, served, clock), PERSON)


def arrive(participant: Participant, name: str) -> Participant:
    arrival = Arrival(
        recruiter_participant=name,
        recruiter_study="one",
        recruiter_session=SITTING,
        visit=f"visit-of-{name}",
        form=ADULT,
    )
    participant.arrive(arrival).begin().take_trial()
    refusal = ConflictError("Wrong page.", "Go on.")
    log_refusal(participant.database, participant.token, "answers", refusal, participant.clock)
    return participant


def other(participant: Participant, name: str = "somebody-else") -> Participant:
    return arrive(participant.another(), name)


def forget_person(person: Participant, name: str = PERSON) -> int:
    return forget(person.database, name, KEY, person.clock)


def pause(person: Participant, name: str) -> None:
    """Let a researcher name somebody in the reason for a decision."""
    reason = f"{name} wrote"
    change_intake(person.database, person.served, person.clock, "paused", by="ada", reason=reason)


def rows(database: Database) -> dict[str, int]:
    with database.reading() as session:
        return {
            table.name: session.scalar(select(func.count()).select_from(table)) or 0
            for table in Base.metadata.sorted_tables
        }


def stored_text(database: Database) -> str:
    with database.reading() as session:
        return "\n".join(
            str(row)
            for table in Base.metadata.sorted_tables
            for row in session.execute(select(table))
        )


@BOTH
def test_erasure_leaves_one_empty_row(person: Participant) -> None:
    before = rows(person.database)
    second = other(person)
    token = second.token

    assert forget_person(person, "somebody-else") == 1

    assert rows(person.database) == before | {
        "study_sessions": 2,
        "audit_lines": before["audit_lines"] + 1,
    }
    text = stored_text(person.database)
    for name in (token, "somebody-else", "visit-of-somebody-else"):
        assert name not in text
    with person.database.reading() as session:
        left = session.scalars(select(StudySession).order_by(StudySession.id)).all()[1]
    # A column that is added later is emptied too, unless it is listed.
    assert left.conditions == []
    assert left.consented_at == left.withdrawn_at == person.clock.now()
    assert {
        column.name
        for column in StudySession.__table__.columns
        if isinstance(column.type, String | Text) and getattr(left, column.name)
    } == {"arm", "arm_design", "token"}
    assert read_once(person.database, study_sessions_table)["state"].tolist() == [
        "started",
        "withdrawn",
    ]
    for table in (responses_table, form_answers_table):
        assert set(read_once(person.database, table)["study_session"]) == {1}


@BOTH
def test_the_log_records_the_erasure_without_a_name(person: Participant) -> None:
    with person.database.writing() as session:
        log_change(
            session, person.clock.now(), Event.UNBLINDED, by="ada", reason=f"{PERSON} wrote to us"
        )
        state = StudyState(finished=0, planned=4, answers=2)
        log_look(session, person.clock.now(), state, way="page", reason=f"{PERSON} wrote")
        session.add(InterimFigures(what="results", document="{}", state="", problem=""))
    second = other(person).stored().id
    why = f"perhaps {PERSON.upper()} too"
    decide_exclusion(person.database, person.clock, second, excluded=True, by="ada", reason=why)
    pause(person, PERSON)

    forget_person(person)

    once = stored_text(person.database)
    assert forget_person(person) == 0
    assert forget_person(person, "") == 0
    assert stored_text(person.database) == once
    assert PERSON not in once.lower()
    # A reason that is added later must be listed too.
    assert {
        column
        for table in Base.metadata.sorted_tables
        for column in table.columns
        if column.name == "reason" or column.name.endswith("_reason")
    } | {AuditLine.__table__.c.detail} == {
        column for text in FREE_TEXTS for column in text.property.columns
    }
    with person.database.reading() as session:
        assert session.scalars(select(Look.reason)).all() == ["(erased) wrote"]
        assert session.scalars(select(InterimFigures)).all() == []
    lines = list(reversed(latest_changes(person.database)))
    assert lines[-1].event == Event.FORGOTTEN
    assert detail_label(lines[-1]) == "study session 1, arm rule_based-mismatched, was started"
    assert (lines[0].researcher, lines[0].reason) == ("ada", "(erased) wrote to us")


def test_the_place_can_be_taken_again_even_by_the_same_person(person: Participant) -> None:
    for name in ("second", "third", "fourth"):
        other(person, name)

    # In capitals or not, it is the same person.
    forget_person(person, f" {PERSON.upper()}")

    with person.database.reading() as session:
        held = session.scalar(select(func.count(Place.study_session_id)))
    assert held == 3
    again = other(person, PERSON)
    assert again.look().state == "started"


def test_a_finished_participant_is_found_by_the_completion_code(person: Participant) -> None:
    while person.look().trial is not None:
        person.take_trial()
    with person.database.reading() as session:
        code = session.scalars(select(StudySession.completion_code)).one()
    assert code is not None

    (entry,) = find_data(person.database, code, None)

    assert (entry.state, entry.answers) == ("completed", 12)
    assert forget(person.database, code, None, person.clock) == 1
    assert code not in stored_text(person.database)


def test_an_invited_participant_is_found_by_the_link(person: Participant) -> None:
    token, screened_out = make_invitations(person.database, 2, person.clock)
    guest = person.another().arrive(Arrival(visit=token_hash(token), form=ADULT))
    note_screen_out(person.database, token_hash(screened_out), "eligibility", person.clock)
    link = f"https://study.example.org/?invitation={token}"
    pause(person, f"holder of {link}, {token}, and {screened_out}")

    assert [entry.study_session for entry in find_data(person.database, link, None)] == [2]
    for name in (link, screened_out):
        assert forget(person.database, name, None, person.clock) == 1
    text = stored_text(person.database)
    assert [secret for secret in (guest.token, token, screened_out) if secret in text] == []
    assert "holder of (erased), (erased), and (erased) wrote" in text


def test_a_screen_out_is_erased_too(person: Participant) -> None:
    for name in ("screened-out", "another"):
        arrival = Arrival(recruiter_participant=name, recruiter_study="one")
        note_screen_out(person.database, arrival.name, "eligibility", person.clock)
    pause(person, "screened-out")

    (entry,) = find_data(person.database, "Screened-Out", KEY)

    assert (entry.study_session, entry.state) == (None, "screened out")
    assert forget_person(person, "Screened-Out") == 1
    assert "screened-out" not in stored_text(person.database)
    assert "another" in stored_text(person.database)


@BOTH
def test_an_answer_during_the_erasure_is_refused(
    person: Participant, monkeypatch: pytest.MonkeyPatch
) -> None:
    trial = person.trial().token
    person.clock.advance(seconds=5)
    person.watch((0.0, 2.0))
    before = len(read_once(person.database, responses_table))
    sent: list[Future[None]] = []

    def begin_sending(*args: object, **keys: object) -> None:
        # Everything is erased by now and nothing is stored yet.
        sent.append(sending.submit(person.answer, trial))
        log_change(*args, **keys)  # type: ignore[arg-type]

    monkeypatch.setattr(forgetting, "log_change", begin_sending)

    with ThreadPoolExecutor() as sending:
        forget_person(person)

    assert before == 2
    assert [type(each.exception()) for each in sent] == [UnknownAddressError]
    assert read_once(person.database, responses_table).empty


def files_of(database: Database, request: pytest.FixtureRequest) -> bytes:
    """Return every byte of the database's files but PostgreSQL's write-ahead log."""
    if database.engine.dialect.name == "sqlite":
        file = Path(str(database.engine.url.database))
        return b"".join(path.read_bytes() for path in sorted(file.parent.glob(f"{file.name}*")))
    server: ThrowawayPostgresql = request.getfixturevalue("postgresql")
    with database.engine.execution_options(isolation_level="AUTOCOMMIT").connect() as connection:
        connection.exec_driver_sql("CHECKPOINT")
    tables = (server.folder / "data" / "base").rglob("*")
    return b"".join(path.read_bytes() for path in tables if path.is_file())


@BOTH
def test_erasure_leaves_no_bytes_in_the_database_files(
    person: Participant, request: pytest.FixtureRequest
) -> None:
    database = person.database
    token = person.token
    kept = other(person)
    names = [PERSON, token, f"visit-of-{PERSON}"]
    assert all(name.encode() in files_of(database, request) for name in names)

    forget(database, PERSON, KEY, person.clock)
    # A server of the study has the database open at the same time, and continues afterwards.
    serving = Database.open(database.engine.url.render_as_string(hide_password=False))
    kept.database = serving
    kept.look()
    scrub(database)
    kept.take_trial()

    left = files_of(database, request)
    assert [name for name in names if name.encode() in left] == []
    assert b"somebody-else" in left
    assert len(read_once(serving, responses_table)) == 4
    serving.close()


@BOTH
def test_a_long_reader_blocks_scrubbing(
    person: Participant, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scrubbing, "LOCK_SECONDS", 0.05)
    forget_person(person)

    with person.database.reading() as session:
        session.execute(select(StudySession)).all()
        if person.database.engine.dialect.name == "sqlite":
            impatient(person.database)
        with pytest.raises(InputError, match=re.compile("are deleted.*again", re.DOTALL)):
            scrub(person.database)
    scrub(person.database)


def impatient(database: Database) -> None:
    """Limit the time that a connection waits for others."""
    connection = database.engine.raw_connection()
    connection.cursor().execute("PRAGMA busy_timeout = 50")
    connection.close()
