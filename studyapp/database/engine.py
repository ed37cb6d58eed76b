"""The study's database: SQLite in the study folder, or PostgreSQL by URL."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from errno import ENOSPC
from functools import cache, cached_property
from pathlib import Path
from shutil import disk_usage
from typing import TYPE_CHECKING, Any, Final, Self
from urllib.parse import unquote

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
from motion.files import write_text
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

# Alembic is imported where it is used: it takes long, and not every command opens a database.
if TYPE_CHECKING:
    from alembic.config import Config
    from alembic.script import ScriptDirectory

LEAST_FREE: Final = 1 << 20
"""Bytes of the disk below which an SQLite database counts as full."""


def sqlite_url(path: Path) -> str:
    """Return the URL of an SQLite file with any name."""
    address = URL.create("sqlite", database=str(path.resolve()))
    return address.render_as_string(hide_password=False)


def database_url_of(folder: Path, *, rehearsal: bool = False) -> str:
    """Return the URL of the database for answers.

    Parameters
    ----------
    folder : Path
        The study folder.
    rehearsal : bool
        Rehearsals have a database of their own, whatever the environment says. Participants'
        answers go to ``DATABASE_URL`` if it is set, or into the study folder.
    """
    files = StudyFolder(folder)
    if rehearsal:
        return sqlite_url(files.rehearsal)
    return os.environ.get("DATABASE_URL") or sqlite_url(files.responses)


@dataclass(frozen=True)
class Database:
    """An open database at the newest schema.

    Several processes may share it. `writing` and `reading` each run one transaction.
    """

    engine: Engine

    @classmethod
    def open(cls, url: str) -> Self:
        """Open the database at `url`; create it, or migrate it to the newest schema.

        Raises
        ------
        InputError
            If the URL is unusable, the file is damaged or not a database, or a newer version of
            Motion Jury created it.
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
        """Open the database at `url` without creating or changing it.

        Parameters
        ----------
        of_any_age : bool
            Whether to open older schemas, too; their tables may differ from
            `studyapp.database.tables`.

        Returns
        -------
        Database or None
            None if there is none yet, or it is empty.

        Raises
        ------
        InputError
            As in `open`; and for an older schema, unless `of_any_age`.
        """
        with _explain_failures(url):
            file = sqlite_file(url)
            if file is not None and not file.exists():
                return None
            engine = _read_only(url)
            with engine.connect() as connection:
                revision = schema_of(connection)
            # SQLite removes its working files only when a database is closed.
            engine.dispose()
        if revision is None:
            return None
        _require_known(revision, url)
        if revision != _newest_schema() and not of_any_age:
            raise InputError(
                f"an older version of Motion Jury created the database (schema {revision})",
                where=display_address(url),
                remedy="Run 'motionjury serve' once: it brings the database to the newest schema",
            )
        return cls(engine)

    @classmethod
    def open_existing(cls, url: str, *, of_any_age: bool = False) -> Self:
        """Open the database at `url` as `open_for_reading` does; `InputError` if there is none."""
        database = cls.open_for_reading(url, of_any_age=of_any_age)
        if database is None:
            raise missing_database(url)
        return database

    @classmethod
    def open_unchecked(cls, url: str) -> Self:
        """Open the database at `url` for reading, without any check."""
        with _explain_failures(url):
            return cls(_read_only(url))

    @contextmanager
    def writing(self) -> Iterator[Session]:
        """Yield a session in a transaction that is committed at the end.

        On SQLite it excludes all other writers. On PostgreSQL writers run concurrently, and wait
        only for locks on the same row or the same `Turn`.
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
        """Yield a read-only session with a consistent snapshot."""
        with Session(self._reader, expire_on_commit=False) as session:
            yield session
            # A rollback would make psycopg discard its prepared statements.
            session.commit()

    @contextmanager
    def looking_up(self) -> Iterator[Connection]:
        """Yield a connection for a single reading statement; for several, use `reading`.

        Without a transaction, PostgreSQL needs one round trip instead of three.
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
        """Raise an error if nothing can be stored, by rewriting a row with its own values."""
        with self.writing() as session:
            session.execute(text("UPDATE alembic_version SET version_num = version_num"))
        # On a full disk, so little still fits into SQLite's log; answers may not.
        file = sqlite_file(str(self.engine.url))
        if file is not None and disk_usage(file).free < LEAST_FREE:
            raise OSError(ENOSPC, os.strerror(ENOSPC))

    def close(self) -> None:
        """Close all connections."""
        self.engine.dispose()


def migration_config(connection: Connection) -> Config:
    """Return Alembic's configuration for `connection`."""
    config = _config()
    config.attributes["connection"] = connection
    return config


def _migrate(engine: Engine, url: str) -> None:
    """Migrate the database to the newest schema; several processes may try at once."""
    from alembic import command

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
            f"another version of Motion Jury created the database (schema {revision}), "
            "and this one cannot read it",
            where=display_address(url),
            remedy="Use the version that created it, or choose another database",
        )


def schema_of(connection: Connection) -> str | None:
    """Return the name of the database's schema; None if it has none yet."""
    from alembic.runtime.migration import MigrationContext

    return MigrationContext.configure(connection).get_current_revision()


def _newest_schema() -> str | None:
    return _schemas().get_current_head()


@cache
def _schemas() -> ScriptDirectory:
    """Return all schemas, cached because reading them is slow."""
    from alembic.script import ScriptDirectory

    return ScriptDirectory.from_config(_config())


def _config() -> Config:
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", "studyapp.database:migrations")
    return config


@contextmanager
def _explain_failures(url: str) -> Iterator[None]:
    """Turn failures of opening the database at `url` into `InputError`."""
    try:
        yield
    except (NoSuchModuleError, ModuleNotFoundError) as error:
        raise InputError(
            f"the database address cannot be used: {error}",
            where=display_address(url),
            remedy="Give an address such as sqlite:////folder/responses.db, and install its driver",
        ) from error
    except DatabaseError as error:
        raise InputError(
            f"the database cannot be opened: {error.orig}",
            where=display_address(url),
            remedy="Check the address, and that the server runs or the file and its disk can be "
            "written; if a file is damaged, restore a backup",
        ) from error


def _address(url: str) -> URL:
    """Parse an address, and give PostgreSQL's the driver's name; `InputError` if that fails."""
    try:
        address = make_url(url)
        usable = _is_usable(address)
    except (ArgumentError, ValueError):
        usable = False
    if not usable:
        raise InputError(
            "the database address cannot be used",
            where="DATABASE_URL",
            remedy="Give an address such as sqlite:////folder/responses.db or "
            "postgresql://user:password@host/database, with %40 for an @ in the password",
        )
    if address.drivername in ("postgres", "postgresql"):
        return address.set(drivername="postgresql+psycopg")
    return address


def _is_usable(address: URL) -> bool:
    if address.get_backend_name() == "sqlite":
        # Each process would have a database of its own in its memory.
        return address.database not in (None, "", ":memory:")
    # No host has an '@': it is one of the password, and the rest of that would be shown.
    return "@" not in (address.host or "")


def display_address(url: str) -> str:
    """Return the address to be read, without its password."""
    return unquote(_address(url).render_as_string(hide_password=True))


def record_database(folder: StudyFolder, url: str) -> None:
    """Note in `folder` which database its answers are in, without the password."""
    with suppress(OSError):  # the server may not be allowed to write there
        write_text(folder.elsewhere, display_address(url), private=True)


def refuse_second_database(folder: StudyFolder) -> None:
    """Raise `InputError` where an empty database would begin beside the one in use elsewhere."""
    if folder.elsewhere.exists() and not folder.responses.exists():
        raise InputError(
            f"the answers of {folder.root.resolve().name} are in another database",
            where=folder.elsewhere.read_text("utf-8"),
            remedy="Set DATABASE_URL to its address; to begin without these answers, remove "
            f"{folder.elsewhere}",
        )


def missing_database(url: str) -> InputError:
    """Return the error where the database at `url` is needed and there is none."""
    return InputError(
        "there is no database of answers yet",
        where=display_address(url),
        remedy="If the study is served with DATABASE_URL, set it here as well",
    )


def sqlite_file(url: str) -> Path | None:
    """Return the file of an SQLite database; None for other databases."""
    address = _address(url)
    if address.get_backend_name() != "sqlite" or not address.database:
        return None
    return Path(address.database)


def _read_only(url: str) -> Engine:
    return _engine(url, changes=False, seconds=READING_SECONDS, postgresql_readonly=True)


def _engine(url: str, *, changes: bool = True, seconds: float, **options: Any) -> Engine:
    address = _address(url)
    # The parameters of a failed statement may include a participant's token.
    hidden = {"hide_parameters": True, "execution_options": options}
    if address.get_backend_name() != "sqlite":
        return postgresql_engine(address, seconds, **hidden)
    return sqlite_engine(address, changes=changes, **hidden)
