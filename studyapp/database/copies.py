"""Copies of a study's database: one SQLite file, whatever the database is.

A copy is a consistent snapshot with the database's schema. It can be restored into SQLite and
PostgreSQL.
"""

import sqlite3
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any, Final

from alembic import command
from sqlalchemy import (
    Connection,
    DateTime,
    MetaData,
    Table,
    create_engine,
    event,
    func,
    select,
)
from sqlalchemy.exc import DBAPIError

from motion.errors import InputError
from studyapp.database.engine import (
    Database,
    display_address,
    migration_config,
    schema_of,
    sqlite_file,
    sqlite_url,
)
from studyapp.database.postgresql import Turn, take_turn, without_timeout
from studyapp.database.tables.base import UtcMoment

SCHEMA: Final = "alembic_version"
"""The table with the schema's name."""

ROWS_AT_ONCE: Final = 1000


def write_copy(url: str, file: Path) -> None:
    """Write a snapshot of the database at `url` to the SQLite file `file`.

    Participants may answer meanwhile: the copy has everything that was acknowledged before, and no
    partial transactions. Deleted data leave no bytes in it.

    Raises
    ------
    InputError
        If there is no database, or it cannot be read.
    """
    try:
        with closing(Database.open_existing(url, of_any_age=True)) as database:
            if database.engine.dialect.name == "sqlite":
                _copy_file(database, file)
            else:
                _copy_rows_to_file(database, file)
    except (DBAPIError, sqlite3.Error) as error:
        raise InputError(
            f"the database could not be copied: {getattr(error, 'orig', error)}",
            where=display_address(url),
            remedy="Check that it is intact, and that there is space where the copy is written",
        ) from error


def compact(file: Path) -> None:
    """Make the SQLite database `file` a single file without deleted data."""
    with closing(sqlite3.connect(file)) as connection:
        connection.execute("PRAGMA journal_mode = DELETE")
        connection.execute("VACUUM")


def count_rows(file: Path) -> dict[str, int]:
    """Count the rows of each table of the copy `file`."""
    engine = create_engine(sqlite_url(file))
    try:
        with engine.connect() as connection:
            return row_counts(connection, _tables_of(connection))
    finally:
        engine.dispose()


def find_flaws(file: Path) -> list[str]:
    """Return everything that is wrong with the copy `file`."""
    try:
        with closing(sqlite3.connect(file)) as connection:
            messages = [str(line) for (line,) in connection.execute("PRAGMA integrity_check")]
            orphans = connection.execute("PRAGMA foreign_key_check").fetchall()
            strangers = connection.execute(
                "SELECT type, name FROM sqlite_master"
                " WHERE type NOT IN ('table', 'index') OR sql LIKE 'CREATE VIRTUAL%'"
            ).fetchall()
    except sqlite3.Error as error:
        return [str(error)]
    flaws = [] if messages == ["ok"] else messages
    if orphans:
        flaws.append(f"{len(orphans)} rows refer to missing rows")
    # Triggers and views could act in place of the tables once the study is served.
    flaws += [f"it has the {kind} {name!r}, which no study has" for kind, name in strangers]
    return flaws


def require_empty(url: str) -> None:
    """Raise `InputError` unless there is nothing at `url` that could be lost.

    That is: no SQLite file, or a PostgreSQL database in which all tables are empty.
    """
    file = sqlite_file(url)
    if file is not None:
        if file.exists():
            raise _not_empty_error(url, "the file exists")
        return
    # Opened properly first, because that explains what is wrong with an address.
    database = Database.open_for_reading(url, of_any_age=True) or Database.open_unchecked(url)
    with closing(database), database.engine.connect() as connection:
        tables = MetaData()
        tables.reflect(connection, only=lambda name, _: name != SCHEMA)
        filled = [name for name, rows in row_counts(connection, tables).items() if rows]
    if filled:
        raise _not_empty_error(url, f"{filled[0]} has rows")


def fill_from_copy(url: str, file: Path) -> None:
    """Restore the copy `file`, at the newest schema, into the empty PostgreSQL database at `url`.

    Everything is stored in one transaction, or nothing.

    Raises
    ------
    InputError
        If the database is not empty, or has other numbers of rows afterwards.
    """
    require_empty(url)
    database = Database.open(url)
    source = create_engine(sqlite_url(file))
    try:
        with (
            database.writing() as session,
            source.connect() as copy,
            ExitStack() as opened,
        ):
            target = session.connection()
            opened.enter_context(without_timeout(target))
            # A server that adds places at this moment does so before or after all of this.
            take_turn(target, Turn.ALLOCATION)
            tables = _tables_of(copy)
            if any(row_counts(target, tables).values()):
                raise _not_empty_error(url, "somebody has just written to it")
            _copy_rows(copy, target, tables)
            _advance_sequences(target, tables)
            if row_counts(target, tables) != row_counts(copy, tables):
                raise InputError(
                    "the database does not have the rows that were written",
                    where=display_address(url),
                    remedy="Check whether anything else writes to it; nothing was stored",
                )
    except DBAPIError as error:
        raise InputError(
            f"the database cannot be filled: {error.orig}",
            where=display_address(url),
            remedy="Fix this and try again: nothing was stored",
        ) from error
    finally:
        source.dispose()
        database.close()


def row_counts(connection: Connection, tables: MetaData) -> dict[str, int]:
    """Count the rows of each table."""
    return {
        table.name: connection.scalar(select(func.count()).select_from(table)) or 0
        for table in sorted(tables.tables.values(), key=lambda each: each.name)
    }


def _copy_file(database: Database, file: Path) -> None:
    """Copy an SQLite database with SQLite's backup, which does not block writers."""
    with closing(database.engine.raw_connection()) as connection:
        source: Any = connection.driver_connection
        with closing(sqlite3.connect(file)) as copy:
            source.backup(copy)
        compact(file)


def _copy_rows_to_file(database: Database, file: Path) -> None:
    """Copy any other database row by row, from one snapshot."""
    target = create_engine(sqlite_url(file))
    try:
        with database.reading() as session:
            source = session.connection()
            schema = schema_of(source)
            with target.begin() as copy:
                command.upgrade(migration_config(copy), str(schema))
                tables = _tables_of(copy)
                _copy_rows(source, copy, tables)
    finally:
        target.dispose()


def _copy_rows(source: Connection, target: Connection, tables: MetaData) -> None:
    for table in tables.sorted_tables:
        result = source.execution_options(yield_per=ROWS_AT_ONCE).execute(
            select(table).order_by(*table.primary_key)
        )
        for rows in result.mappings().partitions():
            target.execute(table.insert(), [dict(row) for row in rows])


def _advance_sequences(connection: Connection, tables: MetaData) -> None:
    """Advance PostgreSQL's sequences to the highest id of each table."""
    for table in tables.sorted_tables:
        counter = func.pg_get_serial_sequence(table.name, "id")
        highest = select(func.max(table.c.id)).scalar_subquery()
        # Sequences of empty tables start at 1.
        connection.execute(select(func.setval(counter, highest)).where(highest.is_not(None)))


def _tables_of(connection: Connection) -> MetaData:
    """Return the tables of a copy, with types that every database knows."""
    tables = MetaData()
    event.listen(tables, "column_reflect", _generalize_type)
    tables.reflect(connection)
    tables.remove(tables.tables[SCHEMA])
    return tables


def _generalize_type(_inspector: Any, _table: Table, column: dict[str, Any]) -> None:
    column["type"] = column["type"].as_generic()
    if isinstance(column["type"], DateTime):
        column["type"] = UtcMoment()


def _not_empty_error(url: str, why: str) -> InputError:
    return InputError(
        f"the database is not empty: {why}",
        where=display_address(url),
        remedy="Restore into a new database, so that nothing can be lost",
    )
