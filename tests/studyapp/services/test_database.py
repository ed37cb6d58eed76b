from __future__ import annotations

import sqlite3
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import create_engine, select, text
from sqlalchemy.exc import DBAPIError

from motion.errors import InputError
from studyapp.bench.throwaway_postgresql import ThrowawayPostgresql
from studyapp.models import Place
from studyapp.services.database import Database, Turn, database_url_of, sqlite_url, take_turn

SQLITE = pytest.mark.parametrize("database_url", ["sqlite"], indirect=True)
POSTGRESQL = pytest.mark.parametrize("database_url", ["postgresql"], indirect=True)


def place(number: int) -> Place:
    return Place(arm="a-b", design="d", number=number)


@SQLITE
def test_a_new_database_is_in_wal_mode_and_keeps_its_references(database: Database) -> None:
    with database.reading() as session:
        assert session.scalar(text("PRAGMA journal_mode")) == "wal"
        assert session.scalar(text("PRAGMA foreign_keys")) == 1


def test_what_was_written_is_there_when_it_is_opened_again(tmp_path: Path) -> None:
    url = sqlite_url(tmp_path / "again.db")
    first = Database.open(url)
    with first.writing() as session:
        session.add(place(0))
    first.close()

    second = Database.open(url)
    with second.reading() as session:
        assert session.scalars(select(Place.number)).all() == [0]
    second.close()


def test_a_failure_stores_nothing(database: Database) -> None:
    with pytest.raises(ZeroDivisionError), database.writing() as session:
        session.add(place(0))
        session.flush()
        _ = 1 / 0

    with database.reading() as session:
        assert session.scalars(select(Place)).all() == []


@SQLITE
def test_a_second_writer_waits_for_the_first(database: Database) -> None:
    order: list[str] = []

    def write_second() -> None:
        with database.writing():
            order.append("second")

    with database.writing():
        other = threading.Thread(target=write_second)
        other.start()
        other.join(timeout=0.3)
        order.append("first")
    other.join()

    assert order == ["first", "second"]


@POSTGRESQL
def test_writers_run_side_by_side_but_for_those_who_take_the_same_turn(database: Database) -> None:
    order: list[str] = []

    def write(name: str, turn: Turn | None) -> None:
        with database.writing() as session:
            if turn is not None:
                take_turn(session.connection(), turn)
            order.append(name)

    with database.writing() as session:
        take_turn(session.connection(), Turn.ALLOCATION)
        others = [
            threading.Thread(target=write, args=(name, turn))
            for name, turn in [("other", Turn.MIGRATION), ("none", None)]
        ]
        for other in others:
            other.start()
            other.join(timeout=30)
        waiting = threading.Thread(target=write, args=("same", Turn.ALLOCATION))
        waiting.start()
        waiting.join(timeout=0.3)
        order.append("first")
    waiting.join(timeout=30)

    assert order == ["other", "none", "first", "same"]


def test_reading_sees_one_state_whatever_is_stored_meanwhile(database: Database) -> None:
    with database.reading() as session:
        before = session.scalars(select(Place.number)).all()
        with database.writing() as other:
            other.add(place(0))

        assert session.scalars(select(Place.number)).all() == before == []
    with database.reading() as session:
        assert session.scalars(select(Place.number)).all() == [0]


def test_several_processes_may_make_the_newest_schema_at_once(
    postgresql: ThrowawayPostgresql,
) -> None:
    url = postgresql.create_database("to_be_migrated")

    with ThreadPoolExecutor(4) as pool:
        opened = list(pool.map(Database.open, [url] * 4))

    for database in opened:
        with database.reading() as session:
            assert session.scalars(select(Place)).all() == []
        database.close()
    postgresql.drop_database("to_be_migrated")


def test_a_database_of_a_newer_schema_is_refused_and_stays_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "newer.db"
    Database.open(sqlite_url(path)).close()
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE alembic_version SET version_num = '9999'")
    connection.close()

    for opening in (Database.open, Database.open_for_reading):
        with pytest.raises(InputError, match=r"newer\.db.*schema \(9999\).*Update Motion Jury"):
            opening(sqlite_url(path))

    with sqlite3.connect(path) as connection:
        versions = connection.execute("SELECT version_num FROM alembic_version").fetchall()
    connection.close()
    assert versions == [("9999",)]


def test_a_damaged_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "damaged.db"
    path.write_bytes(b"this is no database" * 1000)

    with pytest.raises(InputError, match=r"damaged\.db.*not a database.*backup"):
        Database.open(sqlite_url(path))
    with pytest.raises(InputError, match=r"damaged\.db.*not a database.*backup"):
        Database.open_for_reading(sqlite_url(path))


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be opened"):
        Database.open(sqlite_url(tmp_path / "nowhere" / "responses.db"))


@pytest.mark.parametrize("url", ["nonsense", "unknowndatabase://host/name"])
def test_an_unusable_address_is_refused(url: str) -> None:
    with pytest.raises(InputError, match="database address cannot be used"):
        Database.open(url)


@pytest.mark.parametrize("scheme", ["postgresql", "postgres", "postgresql+psycopg"])
def test_an_address_as_hosting_gives_it_is_used_with_the_driver_that_is_installed(
    scheme: str,
) -> None:
    nobody_listens = f"{scheme}://someone:secret@127.0.0.1:1/study"

    with pytest.raises(InputError, match=r"cannot be opened.*[Cc]onnection refused") as caught:
        Database.open(nobody_listens)

    assert "secret" not in str(caught.value)


def test_an_error_does_not_show_the_password() -> None:
    with pytest.raises(InputError) as caught:
        Database.open("unknowndatabase://someone:secret@host/name")

    assert "secret" not in str(caught.value)


def files(folder: Path) -> dict[str, tuple[bytes, int]]:
    return {f.name: (f.read_bytes(), f.stat().st_mtime_ns) for f in folder.iterdir()}


def test_reading_finds_what_was_written_and_leaves_the_file_as_it_is(tmp_path: Path) -> None:
    url = sqlite_url(tmp_path / "answered.db")
    writer = Database.open(url)
    with writer.writing() as session:
        session.add(place(0))
    writer.close()
    before = files(tmp_path)

    reader = Database.open_for_reading(url)
    assert reader is not None
    with reader.reading() as session:
        assert session.scalars(select(Place.number)).all() == [0]
    reader.close()

    assert files(tmp_path) == before


def test_reading_sees_what_a_running_server_has_just_stored(
    database: Database, database_url: str
) -> None:
    reader = Database.open_for_reading(database_url)
    assert reader is not None
    with database.writing() as session:
        session.add(place(0))

    with reader.reading() as session:
        assert session.scalars(select(Place.number)).all() == [0]
    reader.close()


def test_nothing_can_be_stored_in_a_database_opened_for_reading(
    database: Database, database_url: str
) -> None:
    reader = Database.open_for_reading(database_url)
    assert reader is not None

    with pytest.raises(DBAPIError, match=r"read.?only"), reader.writing() as session:
        session.add(place(0))
    reader.close()


@pytest.mark.parametrize("content", [None, b""])
def test_reading_makes_no_database_where_there_is_none(
    tmp_path: Path, content: bytes | None
) -> None:
    path = tmp_path / "none.db"
    if content is not None:
        path.write_bytes(content)
    before = files(tmp_path)

    assert Database.open_for_reading(sqlite_url(path)) is None
    assert files(tmp_path) == before


@pytest.mark.parametrize("empty_url", ["postgresql"], indirect=True)
def test_reading_makes_no_tables_in_an_empty_database_of_postgresql(empty_url: str) -> None:
    assert Database.open_for_reading(empty_url) is None
    assert Database.open_for_reading(empty_url) is None


def test_reading_brings_an_older_schema_to_nothing_newer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "older.db"
    Database.open(sqlite_url(path)).close()
    before = files(tmp_path)
    monkeypatch.setattr("studyapp.services.database._head", lambda: "9999")

    with pytest.raises(InputError, match=r"older\.db.*schema \d{4}.*motionjury serve"):
        Database.open_for_reading(sqlite_url(path))
    assert files(tmp_path) == before


def test_a_failed_statement_does_not_show_what_it_was_given(database: Database) -> None:
    with pytest.raises(DBAPIError) as caught, database.reading() as session:
        session.execute(text("SELECT * FROM nowhere WHERE token = :token"), {"token": "s3cret"})

    assert "s3cret" not in str(caught.value)


ADDRESS = "postgresql://host/study"


@pytest.mark.parametrize(
    ("environment", "given", "rehearsal", "expected"),
    [
        (None, None, False, "responses.db"),
        (None, None, True, "rehearsal.db"),
        (ADDRESS, None, False, ADDRESS),
        (ADDRESS, None, True, "rehearsal.db"),
        (ADDRESS, "sqlite:////given.db", False, "sqlite:////given.db"),
        ("", None, False, "responses.db"),
    ],
)
def test_a_rehearsal_never_answers_into_the_real_database(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    environment: str | None,
    given: str | None,
    rehearsal: bool,
    expected: str,
) -> None:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    if environment is not None:
        monkeypatch.setenv("DATABASE_URL", environment)

    url = database_url_of(tmp_path, database_url=given, rehearsal=rehearsal)

    assert url == (expected if ":" in expected else sqlite_url(tmp_path / expected))


def test_writers_of_a_file_go_in_the_order_they_came(tmp_path: Path) -> None:
    database = Database.open(sqlite_url(tmp_path / "line.db"))
    inside, held = threading.Event(), threading.Event()
    order: list[int] = []

    def write(number: int) -> None:
        with database.writing():
            order.append(number)

    def hold() -> None:
        with database.writing():
            inside.set()
            held.wait(timeout=60)

    with ThreadPoolExecutor(3) as pool:
        first = pool.submit(hold)
        assert inside.wait(timeout=60)
        waiting = []
        for number in range(2):
            waiting.append(pool.submit(write, number))
            while waiters(tmp_path / "line.db-line") <= number:
                assert not first.done()
        held.set()
        for done in (first, *waiting):
            done.result()
    database.close()

    assert order == [0, 1]


def waiters(file: Path) -> int:
    """Return how many wait for the system's lock on `file`."""
    number = file.stat().st_ino if file.exists() else 0
    return sum(
        "->" in line and f":{number} " in line
        for line in Path("/proc/locks").read_text().splitlines()
    )


@pytest.mark.parametrize("database_url", ["postgresql"], indirect=True)
def test_a_connection_that_has_rested_while_its_server_went_away_is_replaced(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    ask = text("SELECT pg_backend_pid()")
    with database.looking_up() as connection:
        resting = connection.execute(ask).scalar_one()
    end = text("SELECT pg_terminate_backend(:pid, 10000)")
    other = Database(create_engine(database.engine.url))
    with other.looking_up() as connection:
        assert connection.execute(end, {"pid": resting}).scalar_one()
    other.close()
    monkeypatch.setattr("studyapp.services.database.REST_SECONDS", 0.0)

    with database.looking_up() as connection:
        assert connection.execute(ask).scalar_one() != resting
