"""The promises that the database itself keeps, whatever the code above it does."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

import pytest
from sqlalchemy.exc import IntegrityError

from studyapp.models import Base, Place, Response, StudySession, Trial, WatchBatch
from studyapp.services.database import Database

NOW = datetime(2026, 5, 4, tzinfo=UTC)


def study_session(token: str, **changes: Any) -> StudySession:
    values: dict[str, Any] = {
        "token": token,
        "comparison": "a-b",
        "reference": "a",
        "other": "b",
        "consented_at": NOW,
        "last_active_at": NOW,
    }
    return StudySession(**(values | changes))


def trial(**changes: Any) -> Trial:
    values: dict[str, Any] = {
        "position": 1,
        "kind": "main",
        "segment": "s",
        "emotion": "anger",
        "speaker": "robin",
        "left_condition": "a",
        "right_condition": "b",
        "duration": 2.0,
        "media_token": "media",
    }
    return Trial(**(values | changes))


def two_sessions_with_one_place() -> list[Base]:
    return [
        Place(comparison="a-b", reference="a", other="b", number=n, study_session_id=1)
        for n in range(2)
    ]


def answers(*values: int) -> list[Base]:
    responses = [Response(question="q", value=value, answered_at=NOW) for value in values]
    return [study_session("two", trials=[trial(responses=responses)])]


@pytest.mark.parametrize(
    "rows",
    [
        pytest.param(two_sessions_with_one_place, id="a session with two places"),
        pytest.param(
            lambda: [Place(comparison="a-b", reference="a", other="b", number=5) for _ in "ab"],
            id="a place twice",
        ),
        pytest.param(lambda: [study_session("one")], id="a token twice"),
        pytest.param(
            lambda: [study_session(t, recruiter_participant="p") for t in "ab"],
            id="a recruiter's participant twice",
        ),
        pytest.param(
            lambda: [study_session("a", completion_code="CODE")], id="a code before the end"
        ),
        pytest.param(lambda: answers(1, 1), id="an answer twice"),
        pytest.param(lambda: answers(3), id="a value out of range"),
        pytest.param(
            lambda: [study_session("a", trials=[trial(), trial(media_token="m")])],  # noqa: S106
            id="two trials at one position",
        ),
        pytest.param(
            lambda: [study_session("a", trials=[trial(expected="left")])],
            id="an expected answer of a trial that is no catch trial",
        ),
        pytest.param(
            lambda: [study_session("a", trials=[trial(answered_at=NOW, unplayable_at=NOW)])],
            id="answered and unplayable",
        ),
        pytest.param(
            lambda: [
                study_session(
                    "a",
                    trials=[
                        trial(
                            watch_batches=[
                                WatchBatch(batch=0, intervals=[], received_at=NOW) for _ in "ab"
                            ]
                        )
                    ],
                )
            ],
            id="a watch batch twice",
        ),
    ],
)
def test_the_database_refuses(database: Database, rows: Callable[[], list[Base]]) -> None:
    with database.writing() as session:
        session.add(study_session("one"))

    with pytest.raises(IntegrityError), database.writing() as session:
        session.add_all(rows())


def test_participants_without_a_recruiter_are_not_taken_for_one(database: Database) -> None:
    with database.writing() as session:
        session.add_all([study_session("one"), study_session("two")])
