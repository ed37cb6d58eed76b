"""The study's real server, run for a rehearsal on a port of this machine alone."""

from __future__ import annotations

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
from types import FrameType
from typing import IO, Final

import httpx

from motion.errors import InputError
from studyapp.rehearsal.visit import study_client
from studyapp.study.folder import StudyFolder
from studyapp.web.mounting import HEALTH
from studyapp.web.server import run_server

HOST: Final = "127.0.0.1"
PROCESSES: Final = 2
START_SECONDS: Final = 120.0
STOP_SECONDS: Final = 60.0
PORTS: Final = range(20_000, 30_000)
"""No system gives these to what only asks others, which might take one before a server does."""


@contextmanager
def rehearsal_server(folder: StudyFolder, *, speed: float) -> Iterator[str]:
    """Serve `folder` as it is served to people, but for the clock and the database.

    However the block ends, the server is stopped.

    Parameters
    ----------
    folder : StudyFolder
        The study; answers go to its ``rehearsal.db``.
    speed : float
        How much faster than real the server's clock runs.

    Yields
    ------
    str
        The server's address.

    Raises
    ------
    InputError
        If it does not start; the message holds its last words.
    """
    port = free_port()
    with tempfile.TemporaryFile() as words, _ended_by_sigterm():
        process = subprocess.Popen(  # noqa: S603 - its own interpreter and module
            [sys.executable, "-m", __name__, str(folder.root), str(port), repr(speed)],
            # Held open by this process alone: its end tells the server that nobody is left.
            stdin=subprocess.PIPE,
            stdout=words,
            stderr=subprocess.STDOUT,
            # Ctrl-C in the terminal is for the rehearsal, which then stops the server itself.
            start_new_session=True,
        )
        try:
            address = f"http://{HOST}:{port}"
            if not _is_up(process, address):
                last = _said(words).splitlines()[-1:]
                raise InputError(
                    f"the study's server did not start: {' '.join(last) or 'it said nothing'}",
                    where=folder.root,
                    remedy="Try 'motionjury serve' to see all it says",
                )
            yield address
        except InputError as error:
            # Shown with the traceback: what failed in the server is in its words alone.
            error.add_note(f"The study's server said: {_said(words) or 'nothing'}")
            raise
        finally:
            _stop(process)


def _said(words: IO[bytes]) -> str:
    """Return all that the server has written so far."""
    words.seek(0)
    return words.read().decode(errors="replace").strip()


def free_port() -> int:
    """Return a port of the loopback that nobody listens on."""
    while True:
        port = secrets.choice(PORTS)
        with suppress(OSError), socket.socket() as listener:
            listener.bind((HOST, port))
            return port


def _is_up(process: subprocess.Popen[bytes], address: str) -> bool:
    """Wait until the server answers; False when it ended or takes too long."""
    deadline = time.monotonic() + START_SECONDS
    with study_client(address) as client:
        while time.monotonic() < deadline and process.poll() is None:
            with suppress(httpx.TransportError):
                if client.get(HEALTH).is_success:
                    return True
            time.sleep(0.1)
    return False


def _stop(process: subprocess.Popen[bytes]) -> None:
    """End the server with all its processes, gently at first."""
    with process:
        process.terminate()
        try:
            process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            # With its worker processes, which have the session that it was started in.
            os.killpg(process.pid, signal.SIGKILL)


@contextmanager
def _ended_by_sigterm() -> Iterator[None]:
    """Let a SIGTERM leave the block as Ctrl-C does, so that the server is not left behind."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def leave(number: int, _frame: FrameType | None) -> None:
        raise SystemExit(128 + number)

    before = signal.signal(signal.SIGTERM, leave)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _serve(arguments: list[str]) -> None:
    """Be the server: study folder, port and speed are the command's arguments."""
    folder, port, speed = arguments
    threading.Thread(target=_end_with_the_rehearsal, daemon=True).start()
    try:
        run_server(Path(folder), HOST, int(port), PROCESSES, rehearsal_speed=float(speed))
    except InputError as error:
        sys.exit(str(error))


def _end_with_the_rehearsal() -> None:
    """Wait until the rehearsal is gone, however it went, and end this server then."""
    os.read(sys.stdin.fileno(), 1)
    os.kill(os.getpid(), signal.SIGTERM)


if __name__ == "__main__":
    _serve(sys.argv[1:])
