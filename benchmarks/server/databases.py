"""The databases that the server is measured and strained with, at full durability."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from studyapp.database.engine import sqlite_url
from tests.support.servers.processes import family_cpu_seconds
from tests.support.servers.throwaway_postgresql import ThrowawayPostgresql, throwaway_postgresql

Backend = Literal["sqlite", "postgresql"]
BACKENDS: Final[tuple[Backend, ...]] = ("sqlite", "postgresql")


@dataclass(frozen=True, kw_only=True)
class FreshDatabase:
    """An empty database of its own.

    Attributes
    ----------
    server : ThrowawayPostgresql or None
        The server it is in; None for SQLite, which is part of whatever opens it.
    """

    backend: Backend
    url: str
    server: ThrowawayPostgresql | None

    def cpu_seconds(self) -> float:
        """Return the processor time that its server has used."""
        if self.server is None:
            return 0.0
        return family_cpu_seconds(self.server.process.pid)

    @property
    def crash(self) -> Callable[[], None] | None:
        """Kills and restarts the database's server, if it has one."""
        if self.server is None:
            return None
        server = self.server

        def kill_and_start() -> None:
            server.kill()
            server.start()

        return kill_and_start


@contextmanager
def fresh_database(backend: Backend, folder: Path) -> Iterator[FreshDatabase]:
    """Give an empty database, which lasts as long as the block.

    Parameters
    ----------
    backend : {'sqlite', 'postgresql'}
        SQLite writes through to the disk at every commit (``synchronous = FULL``), PostgreSQL
        too (``fsync = on``).
    folder : Path
        Where an SQLite file is made.
    """
    if backend == "sqlite":
        yield FreshDatabase(backend=backend, url=sqlite_url(folder / "answers.db"), server=None)
        return
    with throwaway_postgresql() as server:
        yield FreshDatabase(backend=backend, url=server.url, server=server)
