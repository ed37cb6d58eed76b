"""Removing deleted data from the database's files."""

import sqlite3
from collections.abc import Callable
from contextlib import closing
from typing import Any, Final

from sqlalchemy import Engine
from sqlalchemy.exc import DBAPIError

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.sqlite import hold_writer_lock
from studyapp.database.tables.base import Base

LOCK_SECONDS: Final = 30
"""How long to wait for a table; others who need it wait behind this."""

AGAIN: Final = (
    "Run the same command again at a quieter moment: it continues where it stopped, and changes "
    "nothing else"
)


def scrub(database: Database) -> None:
    """Rewrite the database's files, so that they contain no deleted data.

    Deleting only marks rows as free; their bytes stay until the space is reused. SQLite's file is
    rebuilt and its log truncated; in PostgreSQL, each table is rewritten. Servers of the study only
    wait for a moment. Copies that the database keeps itself (PostgreSQL's write-ahead log,
    replicas, archives) expire as configured.

    Raises
    ------
    InputError
        If somebody blocks the rewriting for too long; the deletion itself stands.
    """
    # Imported here: few commands scrub, and psycopg takes long.
    import psycopg

    clean: Callable[[Engine], None] = (
        _rewrite_postgresql if database.engine.dialect.name == "postgresql" else _rewrite_sqlite
    )
    try:
        clean(database.engine)
    except (DBAPIError, psycopg.Error, OSError) as error:
        raise _unfinished(str(getattr(error, "orig", error))) from error


def _rewrite_sqlite(engine: Engine) -> None:
    with hold_writer_lock(engine), closing(engine.raw_connection()) as connection:
        try:
            cursor = connection.cursor()
            cursor.execute("VACUUM")
            # Until it is truncated, the log has earlier states of the pages.
            (busy, _, _) = cursor.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone() or (1, 0, 0)
            cursor.close()
        except sqlite3.Error as error:
            raise _unfinished(str(error)) from error
    if busy:
        raise _unfinished("somebody is reading an earlier state of it")


def _rewrite_postgresql(engine: Engine) -> None:
    refused: list[str] = []

    def note(diagnostic: Any) -> None:
        if diagnostic.severity_nonlocalized == "WARNING":
            refused.append(str(diagnostic.message_primary))

    with engine.execution_options(isolation_level="AUTOCOMMIT").connect() as connection:
        driver: Any = connection.connection.driver_connection
        driver.add_notice_handler(note)
        try:
            driver.patience = None
            connection.exec_driver_sql(f"SET lock_timeout = '{LOCK_SECONDS}s'")
            connection.exec_driver_sql("SET statement_timeout = 0")
            for table in Base.metadata.sorted_tables:
                connection.exec_driver_sql(f"VACUUM (FULL) {table.name}")
        finally:
            driver.remove_notice_handler(note)
            # The connection has no timeouts any more.
            connection.invalidate()
    if refused:
        raise _unfinished("; ".join(refused))


def _unfinished(why: str) -> InputError:
    return InputError(
        "the data are deleted, but their bytes could not be removed from the database's files: "
        f"{why}",
        remedy=AGAIN,
    )
