"""Starting and stopping the processes that train one network together on one machine.

Each runs the same command and reads its rank from torchrun's environment variables: ``WORLD_SIZE``,
``RANK``, ``LOCAL_RANK`` and the address where the processes meet. torchrun and ``accelerate
launch`` set the same variables, on one machine or several. A process that is asked to stop finishes
the current step first.
"""

from __future__ import annotations

import math
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from types import FrameType
from typing import IO, Final

_LOOK_EVERY: Final = 0.1
_SETTLING: Final = 3.0
"""Seconds that the leader, whose output is shown, has to fail by itself after another process."""
_GRACE: Final = 30.0
"""Seconds that the other processes have to exit after one has failed."""


def group_size() -> int:
    """Return the number of processes that the launcher started; 1 without a launcher."""
    return int(os.environ.get("WORLD_SIZE", "1")) if "LOCAL_RANK" in os.environ else 1


def is_leader() -> bool:
    """Return whether this process is the one that prints and writes; true without a launcher."""
    return group_size() == 1 or os.environ.get("RANK", "0") == "0"


def run_in_processes(count: int, command: Sequence[str]) -> int:
    """Run `command` in `count` processes at once, and wait for them.

    The first process leads, and only its output is shown; another one's errors are shown if it
    fails first. Ctrl-C reaches all of them; a SIGTERM is passed on.

    Parameters
    ----------
    count : int
        Number of processes, at least 1.
    command : sequence of str
        The program and its arguments.

    Returns
    -------
    int
        The exit status of the first process that failed, or 0.
    """
    shared = {
        "WORLD_SIZE": str(count),
        "LOCAL_WORLD_SIZE": str(count),
        "MASTER_ADDR": "127.0.0.1",
        "MASTER_PORT": str(_free_port()),
        # Threads of several processes would compete for the same cores.
        "OMP_NUM_THREADS": str(max(1, (os.cpu_count() or 1) // count)),
    }
    with ExitStack() as stack:
        started: list[subprocess.Popen[bytes]] = []
        error_outputs: list[IO[bytes] | None] = []
        stack.enter_context(_signals_passed_on(started))
        for rank in range(count):
            errors = stack.enter_context(tempfile.TemporaryFile()) if rank else None
            error_outputs.append(errors)
            started.append(
                subprocess.Popen(  # noqa: S603 (the command that is running)
                    command,
                    env=shared | os.environ | {"RANK": str(rank), "LOCAL_RANK": str(rank)},
                    stdin=subprocess.DEVNULL if rank else None,
                    stdout=subprocess.DEVNULL if rank else None,
                    stderr=errors,
                )
            )
        failed = _first_failure(started)
        if failed is None:
            return 0
        _end(started)
        output = error_outputs[failed]
        if output is not None:
            output.seek(0)
            sys.stderr.write(output.read().decode(errors="replace"))
        return _status(started[failed].returncode)


def _first_failure(started: Sequence[subprocess.Popen[bytes]]) -> int | None:
    """Return the rank of the first process that failed, or the leader's if it did; None if none."""
    first: int | None = None
    deadline = math.inf
    while time.monotonic() < deadline:
        statuses = [process.poll() for process in started]
        if None not in statuses or statuses[0]:
            return next((rank for rank, status in enumerate(statuses) if status), None)
        if first is None and any(statuses):
            first = next(rank for rank, status in enumerate(statuses) if status)
            deadline = time.monotonic() + _SETTLING
        time.sleep(_LOOK_EVERY)
    return first


def _end(started: Sequence[subprocess.Popen[bytes]]) -> None:
    """Terminate the processes that wait for a failed one."""
    deadline = time.monotonic() + _GRACE
    for process in started:
        if process.poll() is None:
            process.terminate()
    for process in started:
        try:
            process.wait(max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@contextmanager
def _signals_passed_on(started: Sequence[subprocess.Popen[bytes]]) -> Iterator[None]:
    """Leave interruptions to the processes.

    A terminal sends Ctrl-C to all of them. A batch system sends SIGTERM to this process only.
    """

    def pass_on(number: int, frame: FrameType | None) -> None:
        for process in started:
            if process.poll() is None:
                process.send_signal(number)

    previous = {
        signal.SIGINT: signal.signal(signal.SIGINT, lambda number, frame: None),
        signal.SIGTERM: signal.signal(signal.SIGTERM, pass_on),
    }
    try:
        yield
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)


def _status(returncode: int) -> int:
    """Return a shell's exit status: 128 plus the signal if one ended the process."""
    return returncode if returncode >= 0 else 128 - returncode


def _free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def stop_request(*, heeded: int = 1) -> Iterator[list[int]]:
    """Collect SIGINT and SIGTERM in a list instead of interrupting the block.

    Outside the main thread, where signals cannot be caught, nothing changes.

    Parameters
    ----------
    heeded : int
        Number of requests that are collected; one more interrupts. A launcher of several processes
        may pass on a Ctrl-C that the terminal has already sent to each of them.
    """
    signals: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield signals
        return

    def note(number: int, frame: FrameType | None) -> None:
        if len(signals) >= heeded:
            raise KeyboardInterrupt
        signals.append(number)

    previous = {number: signal.signal(number, note) for number in _SIGNALS}
    try:
        yield signals
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)
