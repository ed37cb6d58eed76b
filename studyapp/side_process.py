"""Work in a process beside the server's: of lower priority, and loading what a server must not."""

import atexit
import gc
import os
import resource
import runpy
import subprocess
import sys
from collections.abc import Mapping
from typing import Final

LESS_URGENT: Final = 10
"""Than the server that participants wait for."""

MOST_PROCESSES: Final = 256
"""Processes that a command may start."""


class SideProcessError(Exception):
    """The process gave no output; the message says why."""


def output_of(
    program: str, *arguments: str, seconds: float, environment: Mapping[str, str] | None = None
) -> bytes:
    """Return what one of our modules writes when it is run in a process of its own.

    Parameters
    ----------
    program : str
        The module's name: it may belong to a room above the one that asks.
    environment : mapping of str to str, optional
        What it finds there besides; for what may hold a password.

    Raises
    ------
    SideProcessError
        If it cannot be started, ends with another status than 0, or takes too long. It has ended
        then.
    """
    try:
        done = _run(program, *arguments, seconds=seconds, environment=environment or {})
    except subprocess.TimeoutExpired:
        raise SideProcessError(f"It took longer than {seconds:g} seconds and was stopped") from None
    except OSError as error:
        raise SideProcessError(f"It could not be started ({error.strerror})") from error
    if done.returncode:
        lines = done.stderr.decode("utf-8", "replace").strip().splitlines()
        raise SideProcessError(lines[-1] if lines else f"It ended with {done.returncode}")
    return done.stdout


def _run(
    program: str, *arguments: str, seconds: float, environment: Mapping[str, str]
) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(  # noqa: S603 - our own program
        # Without -P, a folder that happens to be called like a package would be taken for it.
        [sys.executable, "-P", "-m", "studyapp.side_process", program, *arguments],
        env={
            **os.environ,
            **environment,
            "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1",
        },
        capture_output=True,
        timeout=seconds,
        check=False,
    )


def available_processors() -> int:
    """Return the number of processors that this process may use, at most `MOST_PROCESSES`."""
    if hasattr(os, "sched_getaffinity"):
        return min(len(os.sched_getaffinity(0)), MOST_PROCESSES)
    return min(os.cpu_count() or 1, MOST_PROCESSES)


def collect_garbage_seldom() -> None:
    """Let this process collect garbage seldom, and not when it ends.

    What it imports stays: looking through it takes up to a third of the time of a short command.
    """
    gc.set_threshold(10_000)
    atexit.register(gc.freeze)


def give_way(processor_seconds: int) -> None:
    """Let this process come after the server's, and end once it has used the processor so long."""
    os.nice(LESS_URGENT)
    resource.setrlimit(resource.RLIMIT_CPU, (processor_seconds, processor_seconds))


if __name__ == "__main__":
    collect_garbage_seldom()
    del sys.argv[0]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
