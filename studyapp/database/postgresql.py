"""PostgreSQL: connections with timeouts, and turns for which server processes wait."""

import hashlib
import time
from collections.abc import Iterator
from contextlib import contextmanager
from enum import IntEnum
from typing import Any, Final

from sqlalchemy import (
    URL,
    BigInteger,
    Connection,
    Engine,
    bindparam,
    create_engine,
    event,
    func,
    select,
)
from sqlalchemy.engine.interfaces import DBAPIConnection
from sqlalchemy.exc import DisconnectionError
from sqlalchemy.pool import ConnectionPoolEntry, PoolProxiedConnection

CONNECT_SECONDS: Final = 3
"""Timeout of connecting."""

ALIVE_SECONDS: Final = 3.0
"""Timeout of the test whether a server is alive."""

STATEMENT_SECONDS: Final = 30.0
"""Timeout of a statement, waits for locks included."""

READING_SECONDS: Final = 600.0
"""Timeout of a statement of reading commands: a report reads whole tables."""

GRACE_SECONDS: Final = 2.0
"""How long to wait for the server's own timeout; a frozen server never reports it."""

IDLE_SECONDS: Final = 1.0
"""After so long without use, a connection is tested first."""

IDLE_SINCE: Final = "rests_since"


MAX_CONNECTIONS: Final = 15
"""Connections of a process, which are kept open: opening one costs as much as a page."""


def postgresql_engine(address: URL, seconds: float, **options: Any) -> Engine:
    """Return an engine with a timeout of `seconds` for each statement."""
    # Imported here: psycopg takes long, and most studies use SQLite.
    from studyapp.database.patient_connection import PatientConnection

    engine = create_engine(
        address,
        # Writers rely on locks, whatever the server's default is.
        isolation_level="READ COMMITTED",
        pool_size=MAX_CONNECTIONS,
        max_overflow=0,
        # The connection used last has the most prepared statements.
        pool_use_lifo=True,
        **options,
    )

    @event.listens_for(engine, "do_connect")
    def connect(_dialect: Any, _record: Any, arguments: list[Any], named: dict[str, Any]) -> Any:
        connection = PatientConnection.connect(
            *arguments, **{"connect_timeout": CONNECT_SECONDS, **named}
        )
        connection.patience = ALIVE_SECONDS
        connection.execute(f"SET statement_timeout = {round(1000 * seconds)}")
        connection.commit()
        connection.patience = seconds + GRACE_SECONDS
        return connection

    event.listen(engine, "checkin", _note_idle_since)
    event.listen(engine, "checkout", _require_alive)
    return engine


@contextmanager
def without_timeout(connection: Connection) -> Iterator[None]:
    """Lift the timeout for the current transaction on `connection`."""
    if connection.dialect.name != "postgresql":
        yield
        return
    driver: Any = connection.connection.driver_connection
    patience, driver.patience = driver.patience, None
    try:
        connection.exec_driver_sql("SET LOCAL statement_timeout = 0")
        yield
    finally:
        driver.patience = patience


def _note_idle_since(_connection: DBAPIConnection | None, record: ConnectionPoolEntry) -> None:
    record.info[IDLE_SINCE] = time.monotonic()


def _require_alive(
    connection: DBAPIConnection, record: ConnectionPoolEntry, _proxy: PoolProxiedConnection
) -> None:
    """Replace an idle connection whose server has gone away; testing each use would be slow."""
    since = record.info.get(IDLE_SINCE)
    if since is None or time.monotonic() - since < IDLE_SECONDS:
        return
    from psycopg import Error

    driver: Any = connection
    patience, driver.patience = driver.patience, ALIVE_SECONDS
    try:
        connection.cursor().execute("SELECT 1")
        connection.commit()
    except Error as error:
        raise DisconnectionError from error
    finally:
        driver.patience = patience


class Turn(IntEnum):
    """What server processes do one at a time; the values are keys of advisory locks."""

    MIGRATION = 8_675_110_001
    ALLOCATION = 8_675_110_002
    LOGIN = 8_675_110_003
    FIGURES = 8_675_110_004


SHARE: Final = select(
    func.pg_advisory_xact_lock(bindparam("own", type_=BigInteger)),
    func.pg_advisory_xact_lock_shared(bindparam("turn", type_=BigInteger)),
)


def take_turn(connection: Connection, turn: Turn) -> None:
    """Wait for `turn`, and hold it exclusively until the transaction ends.

    On SQLite a writing transaction is always alone.
    """
    if connection.dialect.name == "postgresql":
        connection.execute(select(func.pg_advisory_xact_lock(int(turn))))


def share_turn(connection: Connection, turn: Turn, name: str) -> None:
    """Wait for `turn`, and share it with other names until the transaction ends.

    On SQLite a writing transaction is always alone.
    """
    if connection.dialect.name == "postgresql":
        digest = hashlib.sha256(f"{turn.name} {name}".encode()).digest()
        own = int.from_bytes(digest[:8], "big", signed=True)
        connection.execute(SHARE, {"own": own, "turn": int(turn)})
