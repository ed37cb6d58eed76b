from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text

from motion.errors import InputError
from tests.support.servers import throwaway_postgresql as module
from tests.support.servers.throwaway_postgresql import ThrowawayPostgresql, throwaway_postgresql

pytestmark = pytest.mark.skipif(
    module.programs() is None, reason="PostgreSQL (Debian's package) is not installed"
)


def run(url: str, *statements: str) -> list[int]:
    """Run `statements` and return the numbers that the last one finds."""
    engine = create_engine(url)
    with engine.begin() as connection:
        for statement in statements:
            result = connection.execute(text(statement))
        numbers = [row[0] for row in result] if result.returns_rows else []
    engine.dispose()
    return numbers


def test_committed_rows_survive_a_killed_server_and_nothing_is_left_after_a_failure() -> None:
    with pytest.raises(ZeroDivisionError), throwaway_postgresql() as server:
        folder = server.folder
        run(server.url, "CREATE TABLE kept (n int)", "INSERT INTO kept VALUES (7)")

        server.kill()
        server.start()

        assert run(server.url, "SELECT n FROM kept") == [7]
        assert run(
            server.url, "SELECT count(*) FROM pg_settings WHERE name = 'fsync' AND setting = 'on'"
        ) == [1]
        copies_go_their_own_way(server)
        _ = 1 / 0

    assert server.process.poll() is not None
    assert not folder.exists()


def copies_go_their_own_way(server: ThrowawayPostgresql) -> None:
    copy = server.create_database("copy", template="motionjury")

    run(copy, "INSERT INTO kept VALUES (8)")

    assert run(copy, "SELECT n FROM kept ORDER BY n") == [7, 8]
    assert run(server.url, "SELECT n FROM kept") == [7]
    server.drop_database("copy")
    assert run(server.url, "SELECT count(*) FROM pg_database WHERE datname = 'copy'") == [0]


PROGRAM = """
from tests.support.servers.throwaway_postgresql import throwaway_postgresql
with throwaway_postgresql(durable=False) as server:
    print(server.folder, flush=True)
    input()
"""


def test_nothing_is_left_when_the_program_that_uses_it_is_killed() -> None:
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as program:
        assert program.stdout is not None
        folder = Path(program.stdout.readline().strip())
        assert (folder / "data" / "postmaster.pid").exists()

        os.kill(program.pid, signal.SIGKILL)
        program.communicate()

    end = time.monotonic() + 30
    while folder.exists():
        assert time.monotonic() < end, "the server's folder is still there"
        time.sleep(0.05)


def test_a_machine_without_postgresql_is_told_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "programs", lambda: None)

    with (
        pytest.raises(InputError, match=r"not installed.*apt-get install postgresql"),
        throwaway_postgresql(),
    ):
        pytest.fail("there is no server to be had")
