"""Opening the study's database: SQLite beside the study, or PostgreSQL by address."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any, Self

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import (
    URL,
    Connection,
    Engine,
    text,
)
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, DatabaseError, NoSuchModuleError
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.database.postgresql import (
    READING_SECONDS,
    STATEMENT_SECONDS,
    Turn,
    postgresql_engine,
    take_turn,
    without_timeout,
)
from studyapp.database.sqlite import hold_writer_lock, keep_private, sqlite_engine
from studyapp.study.folder import StudyFolder


def sqlite_url(path: Path) -> str:
    """Return the database address of an SQLite file, whatever letters its folders' names hold."""
    address = URL.create("sqlite", database=str(path.resolve()))
    return address.render_as_string(hide_password=False)


def database_url_of(
    folder: Path, *, database_url: str | None = None, rehearsal: bool = False
) -> str:
    """Return the address of the database that answers go to.

    Parameters
    ----------
    folder : Path
        The study folder.
    database_url : str, optional
        Takes precedence over everything else.
    rehearsal : bool
        A rehearsal's answers go to a database of their own, whatever the environment says;
        those of participants to ``DATABASE_URL`` where it is set, else beside the study.
    """
    if database_url is not None:
        return database_url
    files = StudyFolder(folder)
    if rehearsal:
        return sqlite_url(files.rehearsal)
    return os.environ.get("DATABASE_URL") or sqlite_url(files.responses)


@dataclass(frozen=True)
class Database:
    """An open database at the newest schema.

    Several processes may have the same one open. Work is done in `writing` or `reading`, each
    one transaction: all of it is stored, or nothing.
    """

    engine: Engine

    @classmethod
    def open(cls, url: str) -> Self:
        """Open the database at `url`, making it or bringing it to the newest schema.

        Raises
        ------
        InputError
            If the address is unusable, the file is not a database or damaged, or a newer version
            of Motion Jury made it.
        """
        with _explain_failures(url):
            if (file := sqlite_file(url)) is not None:
                keep_private(file)
            engine = _engine(url, seconds=STATEMENT_SECONDS)
            with engine.connect() as connection:
                is_current = schema_of(connection) == _newest_schema()
            if not is_current:
                _migrate(engine, url)
        return cls(engine)

    @classmethod
    def open_for_reading(cls, url: str, *, of_any_age: bool = False) -> Self | None:
        """Open the database at `url` as it is: it is neither made nor changed.

        Parameters
        ----------
        of_any_age : bool
            Whether one that an older version made is opened as well; its tables may differ from
            `studyapp.database.tables`.

        Returns
        -------
        Database or None
            None where there is none yet, or an empty one.

        Raises
        ------
        InputError
            As in `open`; and if an older version of Motion Jury made it, unless `of_any_age`.
        """
        with _explain_failures(url):
            file = sqlite_file(url)
            if file is not None and not file.exists():
                return None
            engine = _read_only(url)
            with engine.connect() as connection:
                revision = schema_of(connection)
            # Only a closed database leaves no working files beside it.
            engine.dispose()
        if revision is None:
            return None
        _require_known(revision, url)
        if revision != _newest_schema() and not of_any_age:
            raise InputError(
                f"an older version of Motion Jury made the database (schema {revision})",
                where=display_address(url),
                remedy="Run 'motionjury serve' once: it brings the database to the newest schema",
            )
        return cls(engine)

    @classmethod
    def open_unchecked(cls, url: str) -> Self:
        """Give the database at `url` for reading, whatever is in it; nothing is looked at yet."""
        with _explain_failures(url):
            return cls(_read_only(url))

    @contextmanager
    def writing(self) -> Iterator[Session]:
        """Give a session whose transaction is stored at the end.

        On SQLite it excludes all other writers. On PostgreSQL writers run side by side; they wait
        for each other where they lock the same row or take the same `Turn`.
        """
        with (
            hold_writer_lock(self.engine),
            Session(self._writer, expire_on_commit=False) as session,
            session.begin(),
        ):
            # On SQLite, take the lock now, not at the first statement.
            session.connection()
            yield session

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """Give a session that sees one state of the database and stores nothing."""
        with Session(self._reader, expire_on_commit=False) as session:
            yield session
            # Not rolled back: psycopg then gives up the statements that it has prepared.
            session.commit()

    @contextmanager
    def looking_up(self) -> Iterator[Connection]:
        """Give a connection for one statement that only reads; for several, see `reading`.

        A statement sees one state of the database anyway. PostgreSQL is spared the transaction
        around it: two journeys of three.
        """
        with self._looker.connect() as connection:
            yield connection

    @cached_property
    def _writer(self) -> Engine:
        return self.engine.execution_options(writes=True)

    @cached_property
    def _reader(self) -> Engine:
        return self._on_postgresql(isolation_level="REPEATABLE READ", postgresql_readonly=True)

    @cached_property
    def _looker(self) -> Engine:
        return self._on_postgresql(isolation_level="AUTOCOMMIT")

    def _on_postgresql(self, **options: Any) -> Engine:
        if self.engine.dialect.name != "postgresql":
            return self.engine
        return self.engine.execution_options(**options)

    def check_writable(self) -> None:
        """Store what is stored already: where that fails, no answer could be stored either."""
        with self.writing() as session:
            session.execute(text("UPDATE alembic_version SET version_num = version_num"))

    def close(self) -> None:
        """Give back all connections."""
        self.engine.dispose()


def migration_config(connection: Connection) -> Config:
    """Return the configuration with which Alembic works on `connection`."""
    config = _config()
    config.attributes["connection"] = connection
    return config


def _migrate(engine: Engine, url: str) -> None:
    """Bring the database to the newest schema; several processes may try at once."""
    with engine.execution_options(writes=True).begin() as connection, without_timeout(connection):
        take_turn(connection, Turn.MIGRATION)
        revision = schema_of(connection)
        if revision is not None:
            _require_known(revision, url)
        command.upgrade(migration_config(connection), "head")


def _require_known(revision: str, url: str) -> None:
    """Raise `InputError` unless this version knows the schema `revision`."""
    if revision not in {step.revision for step in _schemas().walk_revisions()}:
        raise InputError(
            f"another version of Motion Jury made the database (schema {revision}), "
            "and this one cannot read it",
            where=display_address(url),
            remedy="Use the version that made it, or choose another database",
        )


def schema_of(connection: Connection) -> str | None:
    """Return the name of the database's schema; None where it has none yet."""
    return MigrationContext.configure(connection).get_current_revision()


def _newest_schema() -> str | None:
    return _schemas().get_current_head()


@cache
def _schemas() -> ScriptDirectory:
    """Return all schemas there are; reading them takes longer than opening a database."""
    return ScriptDirectory.from_config(_config())


def _config() -> Config:
    config = Config()
    config.set_main_option("script_location", "studyapp.database:migrations")
    return config


@contextmanager
def _explain_failures(url: str) -> Iterator[None]:
    """Turn failures of opening the database at `url` into `InputError`."""
    try:
        yield
    except (ArgumentError, NoSuchModuleError, ModuleNotFoundError) as error:
        raise InputError(
            f"the database address cannot be used: {error}",
            where=display_address(url),
            remedy="Give an address such as sqlite:////folder/responses.db, and install the "
            "driver it needs",
        ) from error
    except DatabaseError as error:
        remedy = "Check that the server runs, and the name, password and database in the address"
        if _address(url).get_backend_name() == "sqlite":
            remedy = (
                "Check that the path is right and writable; if the file is damaged, put a backup "
                "in its place"
            )
        raise InputError(
            f"the database cannot be opened: {error.orig}",
            where=display_address(url),
            remedy=remedy,
        ) from error


def _address(url: str) -> URL:
    """Return the address in parts; PostgreSQL's, however it is written, with the driver's name."""
    address = make_url(url)
    if address.drivername in ("postgres", "postgresql"):
        return address.set(drivername="postgresql+psycopg")
    return address


def display_address(url: str) -> str:
    """Return the address without its password."""
    try:
        return _address(url).render_as_string(hide_password=True)
    except ArgumentError:
        return "DATABASE_URL"


def sqlite_file(url: str) -> Path | None:
    """Return the file of an SQLite database, None for every other database."""
    address = _address(url)
    if address.get_backend_name() != "sqlite" or not address.database:
        return None
    return Path(address.database)


def _read_only(url: str) -> Engine:
    return _engine(url, changes=False, seconds=READING_SECONDS, postgresql_readonly=True)


def _engine(url: str, *, changes: bool = True, seconds: float, **options: Any) -> Engine:
    address = _address(url)
    # Among the parameters of a failed statement may be a participant's token.
    hidden = {"hide_parameters": True, "execution_options": options}
    if address.get_backend_name() != "sqlite":
        return postgresql_engine(address, seconds, **hidden)
    return sqlite_engine(address, changes=changes, **hidden)
