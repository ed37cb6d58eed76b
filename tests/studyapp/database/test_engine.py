from __future__ import annotations

import fcntl
import os
import shutil
import signal
import socket
import sqlite3
import stat
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import select, text
from sqlalchemy.exc import DBAPIError, OperationalError

from motion.errors import InputError
from studyapp.database.engine import (
    Database,
    database_url_of,
    sqlite_file,
    sqlite_url,
)
from studyapp.database.postgresql import Turn, take_turn, without_timeout
from studyapp.database.sqlite import lock_waiter
from studyapp.database.tables import Place
from tests.support.servers.throwaway_postgresql import ThrowawayPostgresql

SQLITE = pytest.mark.parametrize("database_url", ["sqlite"], indirect=True)
POSTGRESQL = pytest.mark.parametrize("database_url", ["postgresql"], indirect=True)


def place(number: int) -> Place:
    return Place(arm="a-b", design="d", number=number)


@SQLITE
def test_a_new_database_is_in_wal_mode_and_keeps_its_references(database: Database) -> None:
    with database.reading() as session:
        assert session.scalar(text("PRAGMA journal_mode")) == "wal"
        assert session.scalar(text("PRAGMA foreign_keys")) == 1


def test_a_failure_stores_nothing(database: Database) -> None:
    with pytest.raises(ZeroDivisionError), database.writing() as session:
        session.add(place(0))
        session.flush()
        _ = 1 / 0

    with database.reading() as session:
        assert session.scalars(select(Place)).all() == []


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


def test_a_database_of_another_schema_is_refused_and_stays_as_it_is(tmp_path: Path) -> None:
    path, schema = tmp_path / "other.db", "9999"
    Database.open(sqlite_url(path)).close()
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE alembic_version SET version_num = ?", (schema,))
    connection.close()

    for opening in (Database.open, Database.open_for_reading):
        with pytest.raises(
            InputError, match=rf"other\.db.*schema {schema}\).*Use the version that created it"
        ):
            opening(sqlite_url(path))

    with sqlite3.connect(path) as connection:
        versions = connection.execute("SELECT version_num FROM alembic_version").fetchall()
    connection.close()
    assert versions == [(schema,)]


def test_a_damaged_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "damaged.db"
    path.write_bytes(b"this is not a database" * 1000)

    with pytest.raises(InputError, match=r"damaged\.db.*not a database.*backup"):
        Database.open(sqlite_url(path))
    with pytest.raises(InputError, match=r"damaged\.db.*not a database.*backup"):
        Database.open_for_reading(sqlite_url(path))


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be opened"):
        Database.open(sqlite_url(tmp_path / "nowhere" / "responses.db"))


@pytest.mark.parametrize("url", ["nonsense", "unknowndatabase://someone:secret@host/name"])
def test_an_unusable_address_is_refused(url: str) -> None:
    with pytest.raises(InputError, match="database address cannot be used") as caught:
        Database.open(url)
    assert "secret" not in str(caught.value)


@pytest.mark.parametrize("scheme", ["postgresql", "postgres", "postgresql+psycopg"])
def test_an_address_as_hosting_gives_it_is_used_with_the_driver_that_is_installed(
    scheme: str,
) -> None:
    nobody_listens = f"{scheme}://someone:secret@127.0.0.1:1/study"

    with pytest.raises(InputError, match=r"cannot be opened.*[Cc]onnection refused") as caught:
        Database.open(nobody_listens)

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
    monkeypatch.setattr("studyapp.database.engine._newest_schema", lambda: "9999")

    with pytest.raises(InputError, match=r"older\.db.*schema \w+\).*motionjury serve"):
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


@pytest.mark.parametrize("name", ["which?", "a%41", "two words", "a#b", "a?mode=ro&b"])
def test_answers_and_rehearsals_lie_apart_in_a_folder_of_any_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, empty_sqlite: Path, name: str
) -> None:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    folder = tmp_path / name
    folder.mkdir()
    expected = {folder / "responses.db", folder / "rehearsal.db"}
    for file in expected:
        shutil.copyfile(empty_sqlite, file)

    for rehearsal in (False, True):
        url = database_url_of(folder, rehearsal=rehearsal)
        database = Database.open(url)
        with database.writing() as session:
            opened = session.scalar(
                text("SELECT file FROM pragma_database_list WHERE name = 'main'")
            )
        database.close()
        assert sqlite_file(url) == Path(opened)
        expected.remove(Path(opened))

    assert not expected
    assert list(tmp_path.iterdir()) == [folder]


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
            order.append(-1)

    with ThreadPoolExecutor(3) as pool:
        first = pool.submit(hold)
        assert inside.wait(timeout=60)
        waiting = []
        for number in range(2):
            waiting.append(pool.submit(write, number))
            while len(lock_waiter(f"{tmp_path / 'line.db-line'}", os.getpid()).waiting) <= number:
                assert not first.done()
        held.set()
        for done in (first, *waiting):
            done.result()
    database.close()

    assert order == [-1, 0, 1]


@POSTGRESQL
def test_a_frozen_server_is_given_up_and_its_connection_replaced(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("studyapp.database.postgresql.IDLE_SECONDS", 0.0)
    monkeypatch.setattr("studyapp.database.postgresql.ALIVE_SECONDS", 0.2)
    ask = text("SELECT pg_backend_pid()")
    with database.looking_up() as connection:
        frozen = connection.execute(ask).scalar_one()
        driver = connection.connection.driver_connection
        os.kill(frozen, signal.SIGSTOP)
        try:
            driver.patience = 0.2  # type: ignore[union-attr]
            with pytest.raises(OperationalError, match="does not answer"):
                connection.execute(ask)
            connection.invalidate()
        finally:
            os.kill(frozen, signal.SIGCONT)

    with database.looking_up() as connection:
        resting = connection.execute(ask).scalar_one()
    os.kill(resting, signal.SIGSTOP)
    try:
        with database.looking_up() as connection:
            assert connection.execute(ask).scalar_one() not in (frozen, resting)
    finally:
        os.kill(resting, signal.SIGCONT)


@POSTGRESQL
def test_every_statement_has_an_end_unless_it_takes_time(database: Database) -> None:
    limit = text("SHOW statement_timeout")
    with database.writing() as session:
        assert session.scalar(limit) == "30s"
        with without_timeout(session.connection()):
            assert session.scalar(limit) == "0"
    with database.looking_up() as connection:
        assert connection.scalar(limit) == "30s"
    reading = Database.open_for_reading(str(database.engine.url.render_as_string(False)))
    assert reading is not None
    with reading.reading() as session:
        assert session.scalar(limit) == "10min"
    reading.close()


def test_a_server_that_takes_connections_and_says_nothing_is_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("studyapp.database.postgresql.CONNECT_SECONDS", 1)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        url = f"postgresql://ada@127.0.0.1:{silent.getsockname()[1]}/study"

        with pytest.raises(InputError, match="timeout"):
            Database.open(url)


def test_only_its_owner_may_read_a_database_and_all_beside_it(tmp_path: Path) -> None:
    file = tmp_path / "responses.db"
    (tmp_path / "responses.db-line").touch(mode=0o666)
    before = os.umask(0)
    try:
        database = Database.open(sqlite_url(file))
        with database.writing() as session:
            session.execute(text("SELECT 1"))
        modes = {path.name: stat.S_IMODE(path.stat().st_mode) for path in tmp_path.iterdir()}
        database.close()
    finally:
        os.umask(before)

    names = [f"responses.db{ending}" for ending in ("", "-line", "-shm", "-wal")]
    assert modes == dict.fromkeys(names, 0o600)


def test_whoever_holds_the_line_without_end_keeps_others_waiting_for_a_while_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    database = Database.open(sqlite_url(tmp_path / "responses.db"))
    with (tmp_path / "responses.db-line").open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        monkeypatch.setattr("studyapp.database.sqlite.WRITER_LOCK_SECONDS", 0.1)
        for _ in range(2):
            with pytest.raises(InputError, match="db-line: another process has blocked"):
                database.check_writable()
    # Who gave up left nothing locked behind.
    monkeypatch.undo()
    for _ in range(3):
        database.check_writable()
    database.close()
