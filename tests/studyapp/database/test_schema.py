"""The schema: its migrations, and constraints that the database itself enforces."""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta, timezone
from typing import Any

import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import literal, select
from sqlalchemy.exc import IntegrityError, StatementError

from studyapp.database.engine import Database
from studyapp.database.tables.base import Base, UtcMoment
from studyapp.database.tables.study_session import FormAnswer, Place, StudySession, StudyVersion
from studyapp.database.tables.trial import Response, Trial, TrialStimulus, Video, WatchRecord
from tests.support.servers.both_databases import BOTH
from tests.support.studies.stored import filled

NOW = datetime(2026, 5, 4, tzinfo=UTC)
NEW = {"token": "y"}


def study_session(**given: Any) -> Base:
    return filled(StudySession, version_id=1, **given)


def trial(**given: Any) -> Base:
    return filled(
        Trial, **{"study_session_id": 1, "token": "two", "position": 2, "kind": "main"} | given
    )


def answer(**given: Any) -> Base:
    return filled(Response, trial_id=1, **given)


def stored() -> list[Base]:
    """Return a study session with one row of everything that can hang on it."""
    return [
        filled(StudyVersion),
        study_session(recruiter_participant="p"),
        filled(Place, study_session_id=1),
        trial(token="one", position=1),  # noqa: S106
        filled(Video, trial_id=1),
        filled(TrialStimulus, trial_id=1, video_id=1),
        answer(stimulus=None),
        answer(stimulus=1, value=-2),
        filled(WatchRecord, video_id=1),
        filled(FormAnswer, study_session_id=1),
    ]


REFUSED: dict[str, Callable[[], Base]] = {
    "a session with two places": lambda: filled(Place, number=2, study_session_id=1),
    "a place twice": lambda: filled(Place),
    "a token twice": study_session,
    "a recruiter's participant twice": lambda: study_session(**NEW, recruiter_participant="p"),
    "a code before the end": lambda: study_session(**NEW, completion_code="CODE"),
    "an answer twice": answer,
    "an answer about a stimulus twice": lambda: answer(stimulus=1),
    "an answer about a stimulus not shown": lambda: answer(stimulus=3),
    "a value out of range": lambda: answer(question="other", value=101),
    "two trials at one position": lambda: trial(position=1),
    "an expected answer of a trial that is no catch trial": lambda: trial(expected=1),
    "an instructed answer of a trial that is no attention check": lambda: trial(instructed=1),
    "answered and unplayable": lambda: trial(answered_at=NOW, unplayable_at=NOW),
    "two watch records of a video": lambda: filled(WatchRecord, video_id=1),
    "an answer of a form twice": lambda: filled(FormAnswer, study_session_id=1),
}


@pytest.mark.parametrize("refused", REFUSED.values(), ids=REFUSED.keys())
def test_the_database_enforces_its_constraints(
    database: Database, refused: Callable[[], Base]
) -> None:
    with database.writing() as session:
        for each in stored():
            session.add(each)
            session.flush()

    with pytest.raises(IntegrityError) as found, database.writing() as session:
        session.add(refused())
    assert "NOT NULL" not in str(found.value)


def test_timestamps_keep_and_require_a_time_zone(database: Database) -> None:
    paris = datetime(2026, 5, 4, 12, 30, 15, 250, tzinfo=timezone(timedelta(hours=2)))
    with database.reading() as session:
        read = session.scalar(select(literal(paris, UtcMoment())))
        assert read is not None
        assert (read, read.tzinfo) == (paris, UTC)
        with pytest.raises(StatementError, match="time zone"):
            session.scalar(select(literal(paris.replace(tzinfo=None), UtcMoment())))


@BOTH
def test_the_migrated_schema_matches_the_models(database: Database) -> None:
    with database.engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, Base.metadata) == []
