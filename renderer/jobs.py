"""Making videos in several processes.

Each process keeps one OpenGL context, and one thread each for drawing and encoding: on a given
number of cores that is faster than one process with many threads. A job that fails, or takes its
process down with it, is reported; the others go on.
"""

from __future__ import annotations

import multiprocessing
import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Final

from renderer.job import ClipJob, Job, Outcome, PairJob

ONE_THREAD: Final = {
    "LP_NUM_THREADS": "0",  # llvmpipe draws in the calling thread
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
"""Environment of a worker, read by the libraries when they load."""

_PATIENCE: Final = 10.0


def run_jobs(
    jobs: Sequence[Job],
    *,
    processes: int,
    on_done: Callable[[Outcome], None] = lambda outcome: None,
) -> list[Outcome]:
    """Do all `jobs`; a broken one is reported and the rest goes on.

    Parameters
    ----------
    jobs : sequence of ClipJob or PairJob
        What to make. Clip jobs are done before any pair job is begun.
    processes : int
        How many to do at once, at least 1.
    on_done : callable
        Called in this process with each outcome as it comes.

    Returns
    -------
    list of Outcome
        In the order of `jobs`.

    Raises
    ------
    KeyboardInterrupt
        When interrupted; the workers are ended first, and no half-written file is left.
    """
    outcomes: dict[int, Outcome] = {}
    numbered = list(enumerate(jobs))
    with _Workers() as workers:
        for kind in (ClipJob, PairJob):
            queue = deque(item for item in numbered if isinstance(item[1], kind))
            for number, outcome in workers.do(queue, processes):
                outcomes[number] = outcome
                on_done(outcome)
    return [outcomes[number] for number, _ in numbered]


@dataclass(eq=False)
class _Worker:
    """A process, the pipe to it, and the number and job that it is busy with."""

    process: SpawnProcess
    pipe: Connection
    busy: tuple[int, Job] | None = None


class _Workers:
    """The worker processes; ended when the ``with`` block is left, however that happens."""

    def __init__(self) -> None:
        self._workers: list[_Worker] = []

    def __enter__(self) -> _Workers:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.process.terminate()
            worker.pipe.close()
        for worker in self._workers:
            worker.process.join(_PATIENCE)
            if worker.process.is_alive():
                worker.process.kill()

    def do(self, queue: deque[tuple[int, Job]], processes: int) -> Iterator[tuple[int, Outcome]]:
        """Yield the outcome of each job in `queue` with its number, in the order they end."""
        while queue or any(worker.busy for worker in self._workers):
            while queue and (worker := self._idle(processes)) is not None:
                worker.busy = queue.popleft()
                worker.pipe.send(worker.busy[1])
            waiting = {worker.pipe: worker for worker in self._workers if worker.busy}
            for pipe in wait(list(waiting)):
                worker = waiting[pipe]  # type: ignore[index]
                if worker.busy is None:
                    continue
                number, job = worker.busy
                worker.busy = None
                yield number, self._received(worker, job)

    def _idle(self, processes: int) -> _Worker | None:
        """Return a worker with nothing to do, a new one if there may be more; None if not."""
        for worker in self._workers:
            if worker.busy is None:
                return worker
        if len(self._workers) >= max(1, processes):
            return None
        self._workers.append(_start_worker())
        return self._workers[-1]

    def _received(self, worker: _Worker, job: Job) -> Outcome:
        """Return what `worker` says of `job`, or that it died over it."""
        try:
            outcome = worker.pipe.recv()
        except (EOFError, ConnectionError):
            worker.process.join(_PATIENCE)
            self._workers.remove(worker)
            worker.pipe.close()
            code = worker.process.exitcode
            reason = f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"
            return Outcome(name=job.name, error=f"the rendering process ended early ({reason})")
        if not isinstance(outcome, Outcome):
            raise TypeError(f"a worker sent {type(outcome).__name__}")
        return outcome


def _start_worker() -> _Worker:
    """Start a process that waits for jobs."""
    # Imported by the new process alone, after its environment is set.
    from renderer.worker import work

    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=work, args=(there,), daemon=True)
    with _environment(ONE_THREAD):
        process.start()
    there.close()
    return _Worker(process=process, pipe=here)


@contextmanager
def _environment(changes: dict[str, str]) -> Iterator[None]:
    """Set environment variables for as long as the block runs."""
    before = {name: os.environ.get(name) for name in changes}
    os.environ.update(changes)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
