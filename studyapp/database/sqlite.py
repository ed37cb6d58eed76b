"""SQLite: its files, its transactions, and a fair lock for writers, threads and processes alike."""

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
"""How long a writer waits for the lock."""


class WriterLockError(InputError):
    """Another process does not release the writers' lock."""


@contextmanager
def hold_writer_lock(engine: Engine) -> Iterator[None]:
    """Hold the writers' lock of an SQLite database during the block.

    SQLite's own waiters poll with growing pauses: under load some starve. This lock only decides
    who is next; SQLite's lock still protects the data. It is the operating system's lock on a file
    beside the database, and ends with its holder. (On the database file itself it would release
    SQLite's locks.)

    Raises
    ------
    WriterLockError
        If nobody releases it within `WRITER_LOCK_SECONDS`.
    """
    if engine.dialect.name != "sqlite" or not engine.url.database:
        yield
        return
    path = f"{engine.url.database}-line"
    line = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    if not lock_waiter(path, os.getpid()).lock(line, WRITER_LOCK_SECONDS):
        raise WriterLockError(
            f"another process has blocked all writers for more than {WRITER_LOCK_SECONDS:g} s",
            where=path,
            remedy="End the process that has locked this file ('fuser' names it)",
        )
    try:
        yield
    finally:
        os.close(line)


class LockWaiter:
    """Waits for the system's lock in its own thread, as the system has no timeout for locks.

    The writers of this process get it in order of arrival.
    """

    def __init__(self) -> None:
        self._asked: SimpleQueue[tuple[int, Future[None]]] = SimpleQueue()
        self._thread: threading.Thread | None = None
        self._starts = threading.Lock()
        self.waiting: set[Future[None]] = set()

    def lock(self, line: int, seconds: float) -> bool:
        """Lock the file `line`, or close it after these seconds; return whether it is locked."""
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
            # It may have been locked at this very moment.
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
    """Return this process's waiter for a lock; a forked process has no thread of its parent."""
    return LockWaiter()


BUSY_SECONDS: Final = 10
"""SQLite's own timeout for its lock, which only other programs hold longer than a moment."""

OWNER_ONLY: Final = 0o600


def sqlite_engine(address: URL, *, changes: bool, **options: Any) -> Engine:
    """Return an engine whose writers lock at once, or that only reads if not `changes`."""
    engine = create_engine(address, connect_args={"timeout": BUSY_SECONDS}, **options)
    event.listen(engine, "connect", _set_up if changes else _forbid_changes)
    event.listen(engine, "begin", _begin)
    return engine


def keep_private(file: Path) -> None:
    """Let only the owner read an SQLite database; create it if there is none.

    SQLite's working files inherit its permissions.
    """
    with suppress(OSError):
        os.close(os.open(file, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, OWNER_ONLY))
    for ending in ("", "-wal", "-shm", "-line"):
        # Permissions of other users' files are theirs to set.
        with suppress(OSError):
            Path(f"{file}{ending}").chmod(OWNER_ONLY)


def _set_up(connection: sqlite3.Connection, _record: Any) -> None:
    # `_begin` opens transactions of the right kind, not the driver.
    connection.isolation_level = None
    for pragma in ("journal_mode = WAL", "foreign_keys = ON", "synchronous = FULL"):
        connection.execute(f"PRAGMA {pragma}")


def _forbid_changes(connection: sqlite3.Connection, _record: Any) -> None:
    connection.isolation_level = None
    connection.execute("PRAGMA query_only = ON")


def _begin(connection: Connection) -> None:
    # Writers lock at once: otherwise they could fail because another has written after they read.
    writes = connection.get_execution_options().get("writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
