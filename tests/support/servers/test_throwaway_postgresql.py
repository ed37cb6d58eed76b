from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.support.servers.throwaway_postgresql import programs

pytestmark = pytest.mark.skipif(
    programs() is None, reason="PostgreSQL (Debian's package) is not installed"
)


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
