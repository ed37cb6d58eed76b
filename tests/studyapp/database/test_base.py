from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone

import pytest
from sqlalchemy import literal, select
from sqlalchemy.exc import StatementError

from studyapp.database.engine import Database
from studyapp.database.tables.base import UtcMoment


def test_a_moment_keeps_its_time_zone_through_the_database(database: Database) -> None:
    paris = datetime(2026, 5, 4, 12, 30, 15, 250, tzinfo=timezone(timedelta(hours=2)))

    with database.reading() as session:
        read = session.scalar(select(literal(paris, UtcMoment())))

    assert read == paris
    assert read is not None
    assert read.tzinfo is UTC


def test_a_moment_without_a_time_zone_is_refused(database: Database) -> None:
    with database.reading() as session, pytest.raises(StatementError, match="time zone"):
        session.scalar(select(literal(datetime(2026, 5, 4), UtcMoment())))  # noqa: DTZ001
