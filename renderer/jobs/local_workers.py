"""Rendering processes on this machine."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Final, Self

from renderer.jobs.job import Job, Outcome, Stages, do_job

ONE_THREAD: Final = {
    "LP_NUM_THREADS": "0",  # llvmpipe draws in the calling thread
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
"""Environment of a rendering process, read by the libraries when they load.

One thread for drawing and one for encoding in one process per core is faster than one process with
many threads.
"""


ATTEMPTS: Final = 2
"""Number of processes that may die over one job before it is given up."""

_END_TIMEOUT: Final = 10.0


@dataclass(frozen=True)
class _Task:
    """A job, its number, and which attempt at it this is."""

    number: int
    job: Job
    attempt: int


@dataclass(eq=False)
class _Worker:
    """A process, the pipe to it, and its current job."""

    process: SpawnProcess
    pipe: Connection
    task: _Task | None = None


class LocalWorkers:
    """Up to `processes` processes; each is started when it is first needed.

    All are ended when the ``with`` block is left, however that happens.
    """

    def __init__(self, processes: int) -> None:
        self._processes = max(1, processes)
        self._workers: list[_Worker] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.process.terminate()
            worker.pipe.close()
        for worker in self._workers:
            worker.process.join(_END_TIMEOUT)
            if worker.process.is_alive():
                worker.process.kill()

    def room(self) -> bool:
        """Return whether a process is idle, or may still be started."""
        return sum(worker.task is not None for worker in self._workers) < self._processes

    def begin(self, number: int, job: Job) -> None:
        """Give `job` to an idle process, or to a new one."""
        task = _Task(number, job, attempt=1)
        for worker in [worker for worker in self._workers if worker.task is None]:
            try:
                worker.pipe.send(job)
            except ConnectionError:  # it died while it was idle
                self._forget(worker)
            else:
                worker.task = task
                return
        self._start_new(task)

    def ended(self) -> Sequence[tuple[int, Outcome]]:
        """Wait until at least one job has ended, and return those that have."""
        ended: list[tuple[int, Outcome]] = []
        while not ended:
            ready = wait([worker.pipe for worker in self._workers if worker.task is not None])
            for worker in [worker for worker in self._workers if worker.pipe in ready]:
                task, worker.task = worker.task, None
                outcome = self._receive(worker, task) if task is not None else None
                if task is not None and outcome is not None:
                    ended.append((task.number, outcome))
        return ended

    def _receive(self, worker: _Worker, task: _Task) -> Outcome | None:
        """Return the outcome of `task`; None if the worker died and a new one has started it."""
        try:
            outcome = worker.pipe.recv()
        except (EOFError, ConnectionError):
            reason = self._forget(worker)
            if task.attempt < ATTEMPTS:
                self._start_new(_Task(task.number, task.job, task.attempt + 1))
                return None
            return Outcome(
                name=task.job.name,
                error=f"the rendering process ended early, {ATTEMPTS} times ({reason})",
            )
        if not isinstance(outcome, Outcome):
            raise TypeError(f"a worker sent {type(outcome).__name__}")
        return outcome

    def _start_new(self, task: _Task) -> None:
        """Have `task` done by a new process."""
        worker = _start_worker()
        worker.task = task
        self._workers.append(worker)
        with suppress(ConnectionError):  # one that died at once is found when it is waited for
            worker.pipe.send(task.job)

    def _forget(self, worker: _Worker) -> str:
        """Leave out a dead process; return how it ended."""
        worker.process.join(_END_TIMEOUT)
        self._workers.remove(worker)
        worker.pipe.close()
        code = worker.process.exitcode
        return f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"


def _start_worker() -> _Worker:
    """Start a process that waits for jobs."""
    context = multiprocessing.get_context("spawn")
    own_end, worker_end = context.Pipe()
    process = context.Process(target=work, args=(worker_end,), daemon=True)
    with _environment(ONE_THREAD):
        process.start()
    worker_end.close()
    return _Worker(process=process, pipe=own_end)


@contextmanager
def _environment(changes: dict[str, str]) -> Iterator[None]:
    """Set environment variables for as long as the block runs."""
    previous = {name: os.environ.get(name) for name in changes}
    os.environ.update(changes)
    try:
        yield
    finally:
        for name, value in previous.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def work(pipe: Connection) -> None:
    """Do the jobs that come through `pipe`, one after the other, until it is closed."""
    # Ctrl-C reaches all processes of a terminal; the parent decides, and ends this one by
    # SIGTERM, which must unwind the stack so that temporary files are removed.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    with Stages() as stages:
        while True:
            try:
                job = pipe.recv()
            except (EOFError, ConnectionError):
                return
            try:
                pipe.send(do_job(job, stages))
            except ConnectionError:  # its result is no longer needed
                return


def _leave(number: int, frame: object) -> None:
    """End the process by unwinding its stack."""
    sys.exit(128 + number)
