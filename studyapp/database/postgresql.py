"""PostgreSQL: connections that wait for no server without end, and turns that processes take."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Iterator
from contextlib import contextmanager
from enum import IntEnum
from typing import Any, Final

import psycopg
from psycopg.abc import RV, PQGen
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
"""How long a connection may take to be made."""

ALIVE_SECONDS: Final = 3.0
"""How long a server may take to say that it is there."""

STATEMENT_SECONDS: Final = 30.0
"""How long a statement may take, waiting for others included."""

READING_SECONDS: Final = 600.0
"""How long one of a command may take that only reads: a report reads whole tables."""

GRACE_SECONDS: Final = 2.0
"""What a server may take to say that a statement took too long; a frozen one says nothing."""

IDLE_SECONDS: Final = 1.0
"""After such a rest, a connection is tried before it is used."""

IDLE_SINCE: Final = "rests_since"


MAX_CONNECTIONS: Final = 15
"""Connections to PostgreSQL that a process has at most, and keeps: to make one costs as much as a
page."""


class PatientConnection(psycopg.Connection[Any]):
    """A connection that gives a server up which does not answer.

    Attributes
    ----------
    patience : float or None
        Seconds that each statement may take; None for any time.
    """

    patience: float | None = None

    def wait(self, gen: PQGen[RV], interval: float = 0.1, timeout: float | None = None) -> RV:
        """Wait for the server; what it does then is unknown, so the connection ends."""
        try:
            return super().wait(gen, interval, self.patience if timeout is None else timeout)
        except psycopg.errors._WaitTimeout as error:
            self.pgconn.finish()
            raise psycopg.OperationalError("the database does not answer") from error


def postgresql_engine(address: URL, seconds: float, **options: Any) -> Engine:
    """Return an engine no statement of which takes longer than `seconds`."""
    engine = create_engine(
        address,
        # Locks are what keeps writers apart, whatever the server's own default is.
        isolation_level="READ COMMITTED",
        pool_size=MAX_CONNECTIONS,
        max_overflow=0,
        # Few are used at all, and the one that was used last has the most prepared.
        pool_use_lifo=True,
        **options,
    )

    @event.listens_for(engine, "do_connect")
    def connect(
        _dialect: Any, _record: Any, arguments: list[Any], named: dict[str, Any]
    ) -> PatientConnection:
        made = PatientConnection.connect(
            *arguments, **{"connect_timeout": CONNECT_SECONDS, **named}
        )
        made.patience = ALIVE_SECONDS
        made.execute(f"SET statement_timeout = {round(1000 * seconds)}")
        made.commit()
        made.patience = seconds + GRACE_SECONDS
        return made

    event.listen(engine, "checkin", _note_idle_since)
    event.listen(engine, "checkout", _require_alive)
    return engine


@contextmanager
def without_timeout(connection: Connection) -> Iterator[None]:
    """Let statements of the present transaction on `connection` take any time."""
    driver: Any = connection.connection.driver_connection
    if not isinstance(driver, PatientConnection):
        yield
        return
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
    """Have a connection that has rested replaced where its server has gone away meanwhile.

    To ask before every use would be a journey to the server for nothing.
    """
    since = record.info.get(IDLE_SINCE)
    if since is None or time.monotonic() - since < IDLE_SECONDS:
        return
    driver: Any = connection
    patience, driver.patience = driver.patience, ALIVE_SECONDS
    try:
        connection.cursor().execute("SELECT 1")
        connection.commit()
    except psycopg.Error as error:
        raise DisconnectionError from error
    finally:
        driver.patience = patience


class Turn(IntEnum):
    """What server processes do one after the other; the numbers are PostgreSQL's lock names."""

    MIGRATION = 8_675_110_001
    ALLOCATION = 8_675_110_002
    LOGIN = 8_675_110_003
    FIGURES = 8_675_110_004


SHARE: Final = select(
    func.pg_advisory_xact_lock(bindparam("own", type_=BigInteger)),
    func.pg_advisory_xact_lock_shared(bindparam("turn", type_=BigInteger)),
)


def take_turn(connection: Connection, turn: Turn) -> None:
    """Wait until no other process has its `turn`; it lasts until the transaction ends.

    On SQLite a transaction that writes is alone anyway.
    """
    if connection.dialect.name == "postgresql":
        connection.execute(select(func.pg_advisory_xact_lock(int(turn))))


def share_turn(connection: Connection, turn: Turn, name: str) -> None:
    """Wait until nobody has the whole `turn`, nor shares it under the same `name`.

    Others share it at the same time under other names. On SQLite a transaction that writes is
    alone anyway.
    """
    if connection.dialect.name == "postgresql":
        digest = hashlib.sha256(f"{turn.name} {name}".encode()).digest()
        own = int.from_bytes(digest[:8], "big", signed=True)
        connection.execute(SHARE, {"own": own, "turn": int(turn)})
