import fcntl
import os
import shutil
import signal
import socket
import sqlite3
import stat
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import make_url, select, text
from sqlalchemy.exc import DBAPIError, OperationalError

from motion.errors import InputError
from studyapp.database.engine import Database, database_url_of, sqlite_file, sqlite_url
from studyapp.database.postgresql import Turn, take_turn, without_timeout
from studyapp.database.sqlite import lock_waiter, sqlite_engine
from studyapp.database.tables.study_session import Place

POSTGRESQL = pytest.mark.parametrize("database_url", ["postgresql"], indirect=True)


def place(number: int) -> Place:
    return Place(arm="a-b", design="d", number=number)


def test_sqlite_commits_are_synced_to_disk(tmp_path: Path) -> None:
    engine = sqlite_engine(make_url(sqlite_url(tmp_path / "new.db")), changes=True)
    with engine.connect() as connection:
        found = [
            connection.scalar(text(f"PRAGMA {name}")) for name in ("synchronous", "journal_mode")
        ]
    engine.dispose()

    assert found == [2, "wal"]


@POSTGRESQL
def test_writers_run_concurrently_unless_they_share_a_lock(database: Database) -> None:
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


def test_readers_see_one_consistent_state(database: Database) -> None:
    with database.reading() as session:
        before = session.scalars(select(Place.number)).all()
        with database.writing() as other:
            other.add(place(0))

        assert session.scalars(select(Place.number)).all() == before == []
    with database.reading() as session:
        assert session.scalars(select(Place.number)).all() == [0]


@pytest.mark.parametrize("empty_url", ["postgresql"], indirect=True)
def test_several_processes_may_upgrade_the_schema_at_once(empty_url: str) -> None:
    with ThreadPoolExecutor(4) as pool:
        opened = list(pool.map(Database.open, [empty_url] * 4))

    for database in opened:
        with database.reading() as session:
            assert session.scalars(select(Place)).all() == []
        database.close()


def test_a_database_with_another_schema_is_refused_unchanged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = sqlite_url(tmp_path / "other.db")
    Database.open(url).close()
    before = files(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr("studyapp.database.engine._newest_schema", lambda: "9999")
        with pytest.raises(InputError, match=r"other\.db.*schema \w+\).*motionjury serve"):
            Database.open_for_reading(url)
    assert files(tmp_path) == before
    with closing(sqlite3.connect(tmp_path / "other.db")) as connection:
        connection.execute("UPDATE alembic_version SET version_num = '9999'")
        connection.commit()
    content = (tmp_path / "other.db").read_bytes()

    for opening in (Database.open, Database.open_for_reading):
        with pytest.raises(
            InputError, match=r"other\.db.*schema 9999\).*Use the version that created it"
        ):
            opening(url)

    assert (tmp_path / "other.db").read_bytes() == content


@pytest.mark.parametrize(
    ("url", "problem"),
    [
        ("sqlite:///:memory:", "address cannot be used"),
        ("postgresql://someone:secret@host:port/study", "database address cannot be used"),
        ("postgresql://someone:top@secret@host/study", "cannot be used.*%40"),
        ("unknowndatabase://someone:secret@host/name", "database address cannot be used"),
        # Hosting writes the scheme in several ways; the installed driver is used for all.
        ("postgres://someone:secret@127.0.0.1:1/study", "cannot be opened.*onnection refused"),
        (sqlite_url(Path("/no where/für/responses.db")), "/no where/für/.*cannot be opened"),
        ("DAMAGED", r"damaged\.db.*not a database.*backup"),
    ],
)
def test_an_unreachable_database_is_reported_without_its_password(
    tmp_path: Path, url: str, problem: str
) -> None:
    (tmp_path / "damaged.db").write_bytes(b"this is not a database" * 1000)

    with pytest.raises(InputError, match=problem) as caught:
        Database.open(sqlite_url(tmp_path / "damaged.db") if url == "DAMAGED" else url)

    assert "secret" not in str(caught.value)


def files(folder: Path) -> dict[str, tuple[bytes, int]]:
    return {f.name: (f.read_bytes(), f.stat().st_mtime_ns) for f in folder.iterdir()}


def test_reading_leaves_the_file_unchanged(tmp_path: Path) -> None:
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


def test_reading_sees_the_latest_commits_of_a_running_server_and_writes_nothing(
    database: Database, database_url: str
) -> None:
    reader = Database.open_for_reading(database_url)
    assert reader is not None
    with closing(reader):
        with database.writing() as session:
            session.add(place(0))
        with reader.reading() as session:
            assert session.scalars(select(Place.number)).all() == [0]
        with pytest.raises(DBAPIError, match=r"read.?only"), reader.writing() as session:
            session.add(place(0))


@pytest.mark.parametrize("empty_url", ["sqlite", "postgresql"], indirect=True)
def test_reading_never_creates_a_database(tmp_path: Path, empty_url: str) -> None:
    for _ in range(2):
        assert Database.open_for_reading(empty_url) is None
    assert not list(tmp_path.iterdir())
    (tmp_path / "empty.db").touch()
    assert Database.open_for_reading(sqlite_url(tmp_path / "empty.db")) is None
    assert (tmp_path / "empty.db").stat().st_size == 0


def test_a_failed_statement_hides_its_parameters(database: Database) -> None:
    with pytest.raises(DBAPIError) as caught, database.reading() as session:
        session.execute(text("SELECT * FROM nowhere WHERE token = :token"), {"token": "s3cret"})

    assert "s3cret" not in str(caught.value)


def test_a_rehearsal_never_answers_into_the_real_database(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DATABASE_URL", "postgresql://host/study")
    study = Path("/study")

    assert database_url_of(study, rehearsal=False) == "postgresql://host/study"
    assert database_url_of(study, rehearsal=True) == sqlite_url(study / "rehearsal.db")


@pytest.mark.parametrize("name", ["which?", "a%41", "two words", "a#b", "a?mode=ro&b"])
def test_answers_and_rehearsals_have_separate_files_in_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, empty_sqlite: Path, name: str
) -> None:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    folder = tmp_path / name
    folder.mkdir()
    for rehearsal, file in ((False, "responses.db"), (True, "rehearsal.db")):
        shutil.copyfile(empty_sqlite, folder / file)
        url = database_url_of(folder, rehearsal=rehearsal)
        with closing(Database.open(url)) as database, database.writing() as session:
            main = text("SELECT file FROM pragma_database_list WHERE name = 'main'")
            assert session.scalar(main) == str(sqlite_file(url)) == str(folder / file)

    assert list(tmp_path.iterdir()) == [folder]


def test_sqlite_writers_are_served_in_order_of_arrival(tmp_path: Path) -> None:
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
def test_the_connection_to_a_frozen_server_is_replaced(
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
def test_statements_have_a_timeout_unless_they_are_long_running(
    database: Database, database_url: str
) -> None:
    limit = text("SHOW statement_timeout")
    with database.writing() as session:
        assert session.scalar(limit) == "30s"
        with without_timeout(session.connection()):
            assert session.scalar(limit) == "0"
    with database.looking_up() as connection:
        assert connection.scalar(limit) == "30s"
    reader = Database.open_for_reading(database_url)
    assert reader is not None
    with closing(reader), reader.reading() as session:
        assert session.scalar(limit) == "10min"


def test_connecting_to_a_silent_server_times_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("studyapp.database.postgresql.CONNECT_SECONDS", 1)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        url = f"postgresql://ada@127.0.0.1:{silent.getsockname()[1]}/study"

        with pytest.raises(InputError, match="timeout"):
            Database.open(url)


def test_only_its_owner_may_read_the_database_files(tmp_path: Path) -> None:
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


def test_a_stuck_writer_blocks_others_only_for_a_limited_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with closing(Database.open(sqlite_url(tmp_path / "responses.db"))) as database:
        with (tmp_path / "responses.db-line").open("w") as held, monkeypatch.context() as patch:
            fcntl.flock(held, fcntl.LOCK_EX)
            patch.setattr("studyapp.database.sqlite.WRITER_LOCK_SECONDS", 0.1)
            for _ in range(2):
                with pytest.raises(InputError, match="db-line: another process has blocked"):
                    database.check_writable()
        # Giving up released all locks.
        for _ in range(3):
            database.check_writable()
