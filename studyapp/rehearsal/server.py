"""The study's real server, run for a rehearsal on a local port."""

import os
import secrets
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Final

import httpx

from motion.errors import InputError
from studyapp.study.folder import StudyFolder
from studyapp.web.mounting import HEALTH
from studyapp.web.server import run_server

HOST: Final = "127.0.0.1"
PROCESSES: Final = 2
START_SECONDS: Final = 120.0
STOP_SECONDS: Final = 60.0
PORTS: Final = range(20_000, 30_000)
"""Systems do not assign these to clients, which could take one before the server does."""


@contextmanager
def rehearsal_server(folder: StudyFolder, *, speed: float) -> Iterator[str]:
    """Serve `folder` as for participants, except for the clock and the database.

    The server is stopped however the block ends.

    Parameters
    ----------
    folder : StudyFolder
        The study; answers are stored in its ``rehearsal.db``.
    speed : float
        Speed of the server's clock, relative to real time.

    Yields
    ------
    str
        The server's address.

    Raises
    ------
    InputError
        If it does not start; the message contains its last output.
    """
    port = free_port()
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(  # noqa: S603 - its own interpreter and module
            [sys.executable, "-m", __name__, str(folder.root), str(port), repr(speed)],
            # Held open by this process; its end tells the server to stop.
            stdin=subprocess.PIPE,
            stdout=output,
            stderr=subprocess.STDOUT,
            # Ctrl-C reaches only the rehearsal, which then stops the server.
            process_group=0,
        )
        try:
            address = f"http://{HOST}:{port}"
            if not _is_up(process, address):
                last = _read_output(output).splitlines()[-1:]
                raise InputError(
                    f"the study's server did not start: {' '.join(last) or 'no output'}",
                    where=folder.root,
                    remedy="Run 'motionjury serve' to see all its output",
                )
            yield address
        except InputError as error:
            # Shown with the traceback: only the output explains what failed in the server.
            error.add_note(f"Output of the study's server: {_read_output(output) or 'none'}")
            raise
        finally:
            _stop(process)


def _read_output(output: IO[bytes]) -> str:
    """Return the server's output so far."""
    output.seek(0)
    return output.read().decode(errors="replace").strip()


def free_port() -> int:
    """Return an unused port of the loopback."""
    while True:
        port = secrets.choice(PORTS)
        with suppress(OSError), socket.socket() as listener:
            listener.bind((HOST, port))
            return port


def _is_up(process: subprocess.Popen[bytes], address: str) -> bool:
    """Wait until the server answers; return False if it ended or takes too long."""
    deadline = time.monotonic() + START_SECONDS
    with httpx.Client(base_url=address, trust_env=False) as client:
        while time.monotonic() < deadline and process.poll() is None:
            with suppress(httpx.TransportError):
                if client.get(HEALTH).is_success:
                    return True
            time.sleep(0.1)
    return False


def _stop(process: subprocess.Popen[bytes]) -> None:
    """Stop the server with all its processes, by force if needed."""
    with process:
        process.terminate()
        try:
            process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            # This includes its worker processes, which share its session.
            os.killpg(process.pid, signal.SIGKILL)


def _serve(arguments: list[str]) -> None:
    """Run the server; the arguments are study folder, port and speed."""
    folder, port, speed = arguments
    threading.Thread(target=_stop_with_rehearsal, daemon=True).start()
    try:
        run_server(Path(folder), HOST, int(port), PROCESSES, rehearsal_speed=float(speed))
    except InputError as error:
        sys.exit(str(error))


def _stop_with_rehearsal() -> None:
    """Wait until the rehearsal has ended, and stop this server."""
    os.read(sys.stdin.fileno(), 1)
    os.kill(os.getpid(), signal.SIGTERM)


if __name__ == "__main__":
    _serve(sys.argv[1:])
