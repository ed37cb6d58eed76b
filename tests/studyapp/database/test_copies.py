"""A copy of a database is complete, and can be restored to either kind."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import create_engine, select, text

from motion.errors import InputError
from studyapp.database.copies import (
    count_rows,
    fill_from_copy,
    find_flaws,
    require_empty,
    write_copy,
)
from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables.base import Base
from studyapp.database.tables.study_session import StudySession
from studyapp.session.enrolment import Arrival
from studyapp.session.served_study import ServedStudy
from tests.support.studies.taking_part_steps import Participant

SQLITE = pytest.mark.parametrize("database_url", ["sqlite"], indirect=True)
"""For tests that do not depend on the kind of database."""

Rows = dict[str, list[tuple[object, ...]]]


def rows_of(database: Database) -> Rows:
    """Return everything that the database holds, as Python sees it."""
    with database.reading() as session:
        return {
            table.name: [
                tuple(row) for row in session.execute(select(table).order_by(*table.primary_key))
            ]
            for table in Base.metadata.sorted_tables
        }


@pytest.fixture
def answered(participant: Participant) -> Participant:
    """Return a participant who has answered a trial, with every column filled."""
    participant.clock.advance(seconds=5.123456)
    participant.take_trial()
    participant.another().arrive(Arrival(recruiter_participant="Zoë 'quotes' \\ 音"))
    return participant


@pytest.fixture
def copy(answered: Participant, database_url: str, tmp_path: Path) -> Path:
    """Return a copy of the database with that participant."""
    write_copy(database_url, tmp_path / "copy.db")
    return tmp_path / "copy.db"


def rows_at(url: str) -> Rows:
    with closing(Database.open(url)) as database:
        return rows_of(database)


def test_a_copy_has_every_row_unchanged(answered: Participant, copy: Path) -> None:
    assert find_flaws(copy) == []
    assert count_rows(copy)["responses"] == 2
    assert rows_at(sqlite_url(copy)) == rows_of(answered.database)


@SQLITE
@pytest.mark.parametrize("empty_url", ["postgresql"], indirect=True)
def test_a_copy_fills_postgresql_and_its_sequences_continue(
    answered: Participant, copy: Path, empty_url: str, served: ServedStudy
) -> None:
    fill_from_copy(empty_url, copy)

    assert rows_at(empty_url) == rows_of(answered.database)
    filled = Database.open(empty_url)
    goes_on = Participant(filled, served, answered.clock, answered.token)
    goes_on.take_trial()
    assert Participant(filled, served, answered.clock).enrol("newcomer").token
    filled.close()
    with pytest.raises(InputError, match="the database is not empty"):
        fill_from_copy(empty_url, copy)


@SQLITE
@pytest.mark.parametrize("empty_url", ["postgresql"], indirect=True)
def test_a_failed_copy_stores_nothing(copy: Path, empty_url: str) -> None:
    with closing(sqlite3.connect(copy)) as changed:
        # PostgreSQL has no such number, and this table is among the last to be filled.
        changed.execute("UPDATE watch_records SET stalls = 4611686018427387904")
        changed.commit()

    with pytest.raises(InputError, match=r"cannot be filled: .*nothing was stored"):
        fill_from_copy(empty_url, copy)

    require_empty(empty_url)


@pytest.mark.parametrize("empty_url", ["postgresql"], indirect=True)
def test_another_programs_database_does_not_count_as_empty(empty_url: str) -> None:
    require_empty(empty_url)
    engine = create_engine(empty_url)
    with engine.begin() as connection:
        connection.execute(text("CREATE TABLE guests (id integer primary key)"))
    require_empty(empty_url)
    with engine.begin() as connection:
        connection.execute(text("INSERT INTO guests VALUES (1)"))
    engine.dispose()

    with pytest.raises(InputError, match="guests has rows"):
        require_empty(empty_url)


@SQLITE
def test_writers_and_readers_continue_during_a_copy(
    answered: Participant, database_url: str, tmp_path: Path
) -> None:
    with answered.database.writing() as session:
        known = session.get(StudySession, 1)
        assert known is not None
        known.sound_tries = 7
        session.flush()
        write_copy(database_url, tmp_path / "copy.db")

    with closing(sqlite3.connect(tmp_path / "copy.db")) as copy:
        assert copy.execute("SELECT sound_tries FROM study_sessions").fetchone() == (0,)


@SQLITE
def test_deleted_data_leaves_no_bytes_in_a_copy(
    participant: Participant, database_url: str, tmp_path: Path
) -> None:
    token = participant.trial().token.encode()
    participant.withdraw()
    file = Path(database_url.removeprefix("sqlite:///"))
    assert any(token in path.read_bytes() for path in file.parent.glob("*.db*"))

    write_copy(database_url, tmp_path / "copy.db")

    assert token not in (tmp_path / "copy.db").read_bytes()
    assert [path.name for path in tmp_path.glob("copy*")] == ["copy.db"]


@SQLITE
def test_a_damaged_copy_is_detected(copy: Path) -> None:
    with closing(sqlite3.connect(copy)) as changed:
        changed.execute("DELETE FROM trials WHERE id = 1")
        changed.executescript(
            "CREATE TRIGGER t AFTER INSERT ON responses BEGIN DELETE FROM responses; END;"
            "CREATE VIEW v AS SELECT * FROM responses"
        )
    flaws = " ".join(find_flaws(copy))
    for flaw in ("rows refer to missing rows", "the trigger 't', which no study", "the view 'v'"):
        assert flaw in flaws

    copy.write_bytes(copy.read_bytes()[:20_000])
    assert find_flaws(copy)
