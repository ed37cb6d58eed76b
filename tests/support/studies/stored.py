"""The whole content of a database, to check whether anything was stored or changed."""

import hashlib
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final, TypeVar

from sqlalchemy import Select, select
from sqlalchemy.orm import Session

from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables.base import Base
from studyapp.database.tables.study_session import RefusalLine
from studyapp.session.form_answers import COUNTS

Found = TypeVar("Found")
MAY_CHANGE: Final = frozenset(
    {"last_active_at", "sound_tries", *(column.key for column in COUNTS.values())}
)
"""Columns that a refusal may change: activity, sound checks tried, and counts of screen-outs."""


def found_in(database: Database, query: Select[Found]) -> Sequence[Found]:
    """Return the first column of what `query` finds."""
    with database.reading() as session:
        return session.scalars(query).all()


def everything_stored(database: Database) -> dict[str, str]:
    """Return a digest of every table's rows.

    Left out are `MAY_CHANGE`, and notes of refusals, whose number the services limit.
    """
    digests = {}
    with database.reading() as session:
        for table in Base.metadata.sorted_tables:
            if table is RefusalLine.__table__:
                continue
            columns = [column for column in table.columns if column.name not in MAY_CHANGE]
            rows = sorted(map(repr, session.execute(select(*columns))))
            digests[table.name] = hashlib.sha256("\n".join(rows).encode()).hexdigest()
    return digests


@contextmanager
def opened(file: Path) -> Iterator[Database]:
    """Open the SQLite database in a file."""
    with closing(Database.open(sqlite_url(file))) as database:
        yield database


@contextmanager
def reading(file: Path) -> Iterator[Session]:
    """Read one state of the SQLite database in a file."""
    with opened(file) as database, database.reading() as session:
        yield session


@contextmanager
def writing(file: Path) -> Iterator[Session]:
    """Write into the SQLite database in a file."""
    with opened(file) as database, database.writing() as session:
        yield session


Row = TypeVar("Row", bound=Base)
FILLING: Final = {
    "String": "x",
    "Text": "x",
    "Integer": 1,
    "Double": 1.0,
    "UtcMoment": datetime(2026, 5, 4, tzinfo=UTC),
    "JSON": [],
}


def filled(table: type[Row], **values: Any) -> Row:
    """Return a row of the given values, with anything in other columns that may not be empty."""
    fillings = {
        column.name: FILLING[type(column.type).__name__]
        for column in table.__table__.columns
        if not (column.nullable or column.primary_key or column.default or column.foreign_keys)
    }
    return table(**(fillings | values))
