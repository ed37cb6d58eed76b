"""SQLite: its files, its transactions, and the line in which its writers wait.

Threads and processes alike wait in the line.
"""

from __future__ import annotations

import fcntl
import os
import sqlite3
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from queue import SimpleQueue
from typing import Any, Final

from sqlalchemy import URL, Connection, Engine, create_engine, event

from motion.errors import InputError

WRITER_LOCK_SECONDS: Final = 30.0
"""How long a writer waits for its turn before it gives up."""


class WriterLockError(InputError):
    """Another process has its turn and does not end it."""


@contextmanager
def hold_writer_lock(engine: Engine) -> Iterator[None]:
    """Let writers of an SQLite file wait in line.

    SQLite's own waiters try again after ever longer pauses: under load some wait for seconds while
    others, who come later, are lucky. The line decides who goes next, not who may: that remains
    SQLite's lock. It is the system's lock on a file beside the database, and ends with whoever
    holds it. (On the database's own file it would undo SQLite's locks.)

    Raises
    ------
    LineHeldError
        If nobody's turn ends for `WRITER_LOCK_SECONDS`.
    """
    if engine.dialect.name != "sqlite" or not engine.url.database:
        yield
        return
    path = f"{engine.url.database}-line"
    line = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    if not lock_waiter(path, os.getpid()).lock(line, WRITER_LOCK_SECONDS):
        raise WriterLockError(
            f"another process keeps everybody from writing for more than {WRITER_LOCK_SECONDS:g} s",
            where=path,
            remedy="End the process that has locked this file ('fuser' names it)",
        )
    try:
        yield
    finally:
        os.close(line)


class LockWaiter:
    """Waits for the system's lock in a thread of its own: the system knows no waiting with an end.

    It waits for one writer of this process after the other, in the order in which they came.
    """

    def __init__(self) -> None:
        self._asked: SimpleQueue[tuple[int, Future[None]]] = SimpleQueue()
        self._thread: threading.Thread | None = None
        self._starts = threading.Lock()
        self.waiting: set[Future[None]] = set()

    def lock(self, line: int, seconds: float) -> bool:
        """Lock the file `line`, or close it after so many seconds; tell which."""
        if not self.waiting and _try_lock(line):
            return True
        with self._starts:
            if self._thread is None:
                self._thread = threading.Thread(target=self._wait, name="line", daemon=True)
                self._thread.start()
        turn: Future[None] = Future()
        self.waiting.add(turn)
        self._asked.put((line, turn))
        try:
            turn.result(seconds)
        except TimeoutError:
            # Its turn may have come at this very moment.
            return not turn.cancel()
        finally:
            self.waiting.discard(turn)
        return True

    def _wait(self) -> None:
        while True:
            line, turn = self._asked.get()
            if not turn.cancelled():
                fcntl.flock(line, fcntl.LOCK_EX)
            if turn.set_running_or_notify_cancel():
                turn.set_result(None)
            else:
                os.close(line)


def _try_lock(line: int) -> bool:
    try:
        fcntl.flock(line, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


@cache
def lock_waiter(_path: str, _process: int) -> LockWaiter:
    """Return this process's keeper of a line; a process that forks does not pass its thread on."""
    return LockWaiter()


BUSY_SECONDS: Final = 30
"""How long a writer waits for another one before it gives up."""

OWNER_ONLY: Final = 0o600


def sqlite_engine(address: URL, *, changes: bool, **options: Any) -> Engine:
    """Return an engine whose writers take SQLite's lock at once, or, without `changes`, none."""
    engine = create_engine(address, connect_args={"timeout": BUSY_SECONDS}, **options)
    event.listen(engine, "connect", _set_up if changes else _forbid_changes)
    event.listen(engine, "begin", _begin)
    return engine


def keep_private(file: Path) -> None:
    """Let its owner alone read an SQLite database, which is made where there is none.

    SQLite gives its working files the rights of the database's own.
    """
    with suppress(OSError):
        os.close(os.open(file, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, OWNER_ONLY))
    for ending in ("", "-wal", "-shm", "-line"):
        # Where it belongs to somebody else, that is for them to say.
        with suppress(OSError):
            Path(f"{file}{ending}").chmod(OWNER_ONLY)


def _set_up(connection: sqlite3.Connection, _record: Any) -> None:
    # The driver must not open transactions by itself: `_begin` does, of the right kind.
    connection.isolation_level = None
    for pragma in ("journal_mode = WAL", "foreign_keys = ON", "synchronous = FULL"):
        connection.execute(f"PRAGMA {pragma}")


def _forbid_changes(connection: sqlite3.Connection, _record: Any) -> None:
    connection.isolation_level = None
    connection.execute("PRAGMA query_only = ON")


def _begin(connection: Connection) -> None:
    # A writer takes the lock at once: one that first reads and then writes could find that
    # another has written in between, and fail.
    writes = connection.get_execution_options().get("writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
