"""The study's real server as processes of its own: measured, killed and started again."""

import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from motion.errors import InputError
from studyapp.rehearsal.server import free_port
from studyapp.web.server import WORKERS, run_server
from tests.support.servers.processes import children, cpu_seconds, is_running

HOST: Final = "127.0.0.1"
SPEED: Final = 10_000.0
"""How much faster than real the server's clock runs: nobody waits for the end of a video."""

WAIT_SECONDS: Final = 60.0
PAUSE: Final = 0.05


class StudyServer:
    """`motionjury serve` in processes of its own, but for its clock.

    Attributes
    ----------
    port : int
        Where on the loopback it listens.
    log : Path
        File with everything that it has written.
    """

    def __init__(
        self, folder: Path, log: Path, *, database_url: str, workers: int, speed: float
    ) -> None:
        self.port = free_port()
        self.log = log
        self._arguments = [str(folder), *map(str, (self.port, workers, speed))]
        # An address may hold a password, and a command line can be read by everybody.
        self._environment = {**os.environ, "DATABASE_URL": database_url}
        self._workers = workers
        self._arbiter: subprocess.Popen[bytes] | None = None

    @property
    def arbiter(self) -> int:
        """The process that starts the workers."""
        if self._arbiter is None:
            raise InputError("the server was not started", where=HOST, remedy="Call start()")
        return self._arbiter.pid

    @property
    def workers(self) -> tuple[int, ...]:
        """The processes that handle requests."""
        return children(self.arbiter)

    def start(self) -> None:
        """Start the server, and wait until it accepts connections.

        After a crash it is tried again until it starts: the address or the database may not be
        free yet.

        Raises
        ------
        InputError
            If it ends at once or does not listen within a minute.
        """
        crashed = self._arbiter is not None
        self._arbiter = self._launch()
        end = time.monotonic() + WAIT_SECONDS
        while time.monotonic() < end:
            if self._arbiter.poll() is not None:
                with self._arbiter:
                    if not crashed:
                        break
                self._arbiter = self._launch()
            if len(self.workers) == self._workers and self._accepts():
                return
            time.sleep(PAUSE)
        self.stop()
        last = self.log.read_text(encoding="utf-8", errors="replace")[-2000:]
        raise InputError(f"the server does not start: {last}", where=HOST, remedy="Fix that")

    def stop(self) -> None:
        """End the server with all its processes, gently."""
        if self._arbiter is None:
            return
        everybody = (self.arbiter, *self.workers)
        with self._arbiter:
            self._arbiter.terminate()
            try:
                self._arbiter.wait(WAIT_SECONDS)
            except subprocess.TimeoutExpired:
                self._arbiter.kill()
        for pid in everybody:
            with suppress(ProcessLookupError):
                if is_running(pid):
                    os.kill(pid, signal.SIGKILL)

    def kill_worker(self, chance: random.Random) -> None:
        """Kill one worker as a crash does; the server starts another one."""
        workers = self.workers
        if workers:
            with suppress(ProcessLookupError):
                os.kill(chance.choice(workers), signal.SIGKILL)

    def kill_arbiter(self) -> None:
        """Kill the process that starts the workers, and wait until they have ended too.

        They notice by themselves that their parent is gone.
        """
        orphans = self.workers
        if self._arbiter is not None:
            with self._arbiter:
                self._arbiter.kill()
        end = time.monotonic() + WAIT_SECONDS
        while any(is_running(pid) for pid in orphans):
            if time.monotonic() > end:
                raise InputError(
                    "workers go on without the process that looks after them",
                    where=HOST,
                    remedy="See whether they notice that their parent is gone",
                )
            time.sleep(PAUSE)

    def cpu_seconds(self) -> float:
        """Return the processor time that the present workers have used."""
        return sum(cpu_seconds(pid) for pid in self.workers)

    def _launch(self) -> subprocess.Popen[bytes]:
        with self.log.open("ab") as log:
            return subprocess.Popen(
                [sys.executable, "-m", __name__, *self._arguments],
                # Held open by this process alone: its end tells the server that nobody is left.
                stdin=subprocess.PIPE,
                stdout=log,
                stderr=log,
                env=self._environment,
                # Ctrl-C in the terminal is for the program that measures.
                start_new_session=True,
            )

    def _accepts(self) -> bool:
        with suppress(OSError):
            socket.create_connection((HOST, self.port), timeout=1).close()
            return True
        return False


@contextmanager
def study_server(
    folder: Path, log: Path, *, database_url: str, workers: int = WORKERS, speed: float = SPEED
) -> Iterator[StudyServer]:
    """Serve the study in `folder` during the block.

    Parameters
    ----------
    folder : Path
        The study.
    log : Path
        Where everything that the server writes goes.
    database_url : str
        Where answers go.
    workers : int
        As of `motionjury serve`.
    speed : float
        How much faster than real the server's clock runs.
    """
    server = StudyServer(folder, log, database_url=database_url, workers=workers, speed=speed)
    try:
        server.start()
        yield server
    finally:
        server.stop()


def _serve(arguments: list[str]) -> None:
    """Be the server."""
    folder, port, workers, speed = arguments
    threading.Thread(target=_end_with_the_measurement, daemon=True).start()
    try:
        run_server(
            Path(folder),
            HOST,
            int(port),
            int(workers),
            database_url=os.environ["DATABASE_URL"],
            rehearsal_speed=float(speed),
        )
    except InputError as error:
        sys.exit(str(error))


def _end_with_the_measurement() -> None:
    """Wait until the program that measures is gone, however it went, and end this server then."""
    os.read(sys.stdin.fileno(), 1)
    os.kill(os.getpid(), signal.SIGTERM)


if __name__ == "__main__":
    _serve(sys.argv[1:])
