"""The second schema, made from a database that people have answered into."""

from __future__ import annotations

from datetime import datetime
from typing import Any

import pytest
from alembic import command
from sqlalchemy import Connection, MetaData, Table, create_engine, insert, select
from sqlalchemy.orm import Session

from studyapp.migrations.carrying import Rows
from studyapp.migrations.pair_rows import with_arms, without_arms
from studyapp.models import StudySession
from studyapp.services.database import Database, migration_config

MOMENT = "2026-05-04 00:00:00.000000"
ON_BOTH = pytest.mark.parametrize("empty_url", ["sqlite", "postgresql"], indirect=True)
TABLES = ("study_sessions", "places", "trials", "responses", "watch_batches")


def trial(number: int, **changes: Any) -> dict[str, Any]:
    return {
        "id": number,
        "study_session_id": 1,
        "position": number,
        "kind": "main",
        "segment": "take-1",
        "emotion": "anger",
        "speaker": "robin",
        "left_condition": "ours",
        "right_condition": "theirs",
        "expected": "",
        "repeats": None,
        "duration": 2.5,
        "media_token": f"media-{number}",
        "shown_at": MOMENT,
        "answered_at": MOMENT,
        "unplayable_at": None,
        "seconds": 4.0,
    } | changes


FIRST: Rows = {
    "study_sessions": [
        {
            "id": 1,
            "token": "token",
            "visit": None,
            "recruiter_participant": "p",
            "recruiter_study": "s",
            "recruiter_session": "x",
            "comparison": "ours-theirs",
            "reference": "ours",
            "other": "theirs",
            "consented_at": MOMENT,
            "started_at": MOMENT,
            "last_active_at": MOMENT,
            "completed_at": None,
            "withdrawn_at": None,
            "completion_code": None,
        }
    ],
    "places": [
        {
            "id": number + 1,
            "comparison": "ours-theirs",
            "reference": "ours",
            "other": "theirs",
            "number": number,
            "study_session_id": 1 if number == 0 else None,
        }
        for number in range(2)
    ],
    "trials": [
        trial(1),
        trial(2, kind="catch", left_condition="broken", right_condition="ours", expected="right"),
    ],
    "responses": [
        {"id": n, "trial_id": n, "question": "rhythm", "value": 3 - 2 * n, "answered_at": MOMENT}
        for n in (1, 2)
    ],
    "watch_batches": [
        {"id": 1, "trial_id": 2, "batch": 0, "intervals": [[0.0, 2.5]], "received_at": MOMENT}
    ],
}


def content(connection: Connection) -> Rows:
    """Return all rows as they are stored."""
    found: Rows = {}
    for name in TABLES:
        table = Table(name, MetaData(), autoload_with=connection)
        rows = connection.execute(select(table).order_by(table.c.id)).mappings()
        found[name] = [dict(row) for row in rows]
    return found


@pytest.fixture
def first(empty_url: str) -> str:
    """Return a database of the first schema with a participant in the middle of it."""
    engine = create_engine(empty_url)
    with engine.begin() as connection:
        command.upgrade(migration_config(connection), "0001")
        for name, rows in FIRST.items():
            table = Table(name, MetaData(), autoload_with=connection)
            connection.execute(insert(table), _as_stored(table, rows))
    engine.dispose()
    return empty_url


def _as_stored(table: Table, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    moments = {c.name for c in table.columns if c.type.python_type is datetime}
    return [
        {
            key: datetime.fromisoformat(value) if key in moments and value else value
            for key, value in row.items()
        }
        for row in rows
    ]


@ON_BOTH
def test_answers_and_places_of_the_first_schema_are_there_in_the_second(first: str) -> None:
    database = Database.open(first)

    with database.reading() as session:
        participant = session.scalars(select(StudySession)).one()
        assert (participant.arm, participant.conditions) == ("ours-theirs", ["ours", "theirs"])
        assert participant.place is not None
        assert participant.version.number == 1
        main, catch = participant.trials
        assert [shown.condition for shown in main.stimuli] == ["ours", "theirs"]
        assert main.responses[0].value == 1
        assert (catch.expected, catch.conditions) == (2, ("broken", "ours"))
        assert catch.responses[0].value == -1
        (video,) = catch.videos
        assert (video.token, video.duration) == ("media-2", 2.5)
        assert video.watch_batches[0].intervals == [[0.0, 2.5]]
    database.close()


@ON_BOTH
def test_going_back_gives_what_there_was(first: str) -> None:
    engine = create_engine(first)
    with engine.begin() as connection:
        before = content(connection)
        config = migration_config(connection)
        command.upgrade(config, "0002")
        command.downgrade(config, "0001")

        assert content(connection) == before
    engine.dispose()


@ON_BOTH
def test_new_rows_can_follow_the_old_ones(first: str) -> None:
    database = Database.open(first)

    with database.writing() as session:
        _add_another(session)
    database.close()


def _add_another(session: Session) -> None:
    known = session.scalars(select(StudySession)).one()
    session.add(
        StudySession(
            token="another",  # noqa: S106
            version=known.version,
            arm=known.arm,
            arm_design=known.arm_design,
            conditions=known.conditions,
            consented_at=known.consented_at,
            last_active_at=known.last_active_at,
        )
    )


@pytest.mark.parametrize(
    "changes",
    [
        {"form_answers": [{"id": 1}]},
        {"study_versions": [{"number": 2}]},
        {"videos": []},
    ],
)
def test_what_the_first_schema_cannot_hold_is_not_thrown_away(changes: Rows) -> None:
    rows: Rows = {**with_arms(FIRST), "form_answers": [], "audit_lines": [], **changes}

    with pytest.raises(ValueError, match="would be lost"):
        without_arms(rows)


def test_a_database_without_anybody_has_no_version_yet() -> None:
    assert with_arms({name: [] for name in TABLES})["study_versions"] == []
