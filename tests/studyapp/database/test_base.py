from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone

import pytest
from sqlalchemy import literal, select
from sqlalchemy.exc import StatementError

from studyapp.database.engine import Database
from studyapp.database.tables.base import UtcMoment


def test_timestamps_keep_and_require_a_time_zone(database: Database) -> None:
    paris = datetime(2026, 5, 4, 12, 30, 15, 250, tzinfo=timezone(timedelta(hours=2)))
    with database.reading() as session:
        read = session.scalar(select(literal(paris, UtcMoment())))
        assert read is not None
        assert (read, read.tzinfo) == (paris, UTC)
        with pytest.raises(StatementError, match="time zone"):
            session.scalar(select(literal(paris.replace(tzinfo=None), UtcMoment())))
