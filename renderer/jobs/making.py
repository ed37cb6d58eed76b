"""Making many videos, by processes of this machine or by a cluster.

A job that fails or repeatedly crashes its process is reported; the others continue.
"""

from __future__ import annotations

import heapq
import multiprocessing
import os
import signal
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from pathlib import Path
from typing import TYPE_CHECKING, Final, Self

from renderer.jobs.doing import Stages, do_job
from renderer.video_jobs import ClipJob, Job, Outcome

if TYPE_CHECKING:
    from renderer.jobs.cluster import ClusterWorkers

ONE_THREAD: Final = {
    "LP_NUM_THREADS": "0",  # llvmpipe draws in the calling thread
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
"""Environment of a rendering process, read by the libraries when they load.

One process per core, each with one thread for drawing and one for encoding, is faster than one
process with many threads.
"""

_ATTEMPTS: Final = 2
"""Number of processes that may crash on one job before it is abandoned."""

_END_TIMEOUT: Final = 10.0


def run_jobs(
    jobs: Sequence[Job],
    *,
    processes: int,
    cluster: str | None = None,
    on_done: Callable[[Outcome], None] = lambda outcome: None,
) -> list[Outcome]:
    """Do all `jobs`; a failed one is reported and the rest continues.

    Parameters
    ----------
    jobs : sequence of ClipJob, DubJob and PairJob
        The jobs. They are started in this order, but none before its clips. If each segment's pairs
        follow its clips, its frames are soon no longer needed.
    processes : int
        Number of jobs at once on this machine, at least 1.
    cluster : str or None
        Address of a Dask scheduler whose workers do the jobs instead.
    on_done : callable
        Called in this process with each outcome.

    Returns
    -------
    list of Outcome
        Outcomes in the order of `jobs`. Jobs whose clip failed are not tried.

    Raises
    ------
    InputError
        If the cluster cannot be used.
    ModuleNotFoundError
        If clips are to be drawn on this machine, but pyrender is not installed.
    KeyboardInterrupt
        When interrupted. Processes of this machine are ended first, and no half-written file is
        left; workers of a cluster finish their current video.
    """
    if not jobs:
        return []
    outcomes: dict[int, Outcome] = {}
    with _workers(jobs, processes, cluster) as workers:
        for number, outcome in _run_in_order(jobs, workers):
            outcomes[number] = outcome
            on_done(outcome)
    return [outcomes[number] for number in range(len(jobs))]


def _workers(
    jobs: Sequence[Job], processes: int, cluster: str | None
) -> LocalWorkers | ClusterWorkers:
    if cluster is None:
        # Otherwise each clip's process would fail, one after the other.
        if any(isinstance(job, ClipJob) for job in jobs) and find_spec("pyrender") is None:
            raise ModuleNotFoundError("No module named 'pyrender'", name="pyrender")
        return LocalWorkers(processes)
    # Imported here: Dask is an optional extra.
    from renderer.jobs.cluster import ClusterWorkers

    return ClusterWorkers(cluster, _required_files(jobs))


def _required_files(jobs: Sequence[Job]) -> list[Path]:
    """Return files that show whether a machine sees the study; one recording is enough."""
    clips = [job for job in jobs if isinstance(job, ClipJob)]
    files = {jobs[0].speech, *(job.body for job in clips)}
    files |= {job.look.expression_matrix for job in clips}
    return sorted(path for path in files if path is not None)


def _run_in_order(
    jobs: Sequence[Job], workers: LocalWorkers | ClusterWorkers
) -> Iterator[tuple[int, Outcome]]:
    """Yield each job's number and outcome as it ends."""
    order = JobOrder(jobs)
    busy = 0
    while True:
        while workers.room() and (number := order.next()) is not None:
            workers.begin(number, jobs[number])
            busy += 1
        if not busy:
            return
        for number, outcome in workers.ended():
            busy -= 1
            blocked: list[int] = []
            if outcome.error is None:
                order.succeeded(number)
            else:
                blocked = order.failed(number)
            yield number, outcome
            error = f"its clip {outcome.name} could not be made"
            for waiting in blocked:
                name = jobs[waiting].name
                yield waiting, Outcome(name=name, error=error, because_of=outcome.name)


class JobOrder:
    """The order of the jobs of one run, each identified by its index.

    A pair or a dubbed video waits for its clips if they are among the jobs; other clips exist
    already.
    """

    def __init__(self, jobs: Sequence[Job]) -> None:
        made_by = {path: number for number, job in enumerate(jobs) for path in job.outputs}
        self._awaited: dict[int, set[int]] = {}
        self._waiting_for: defaultdict[int, list[int]] = defaultdict(list)
        self._ready: list[int] = []
        for number, job in enumerate(jobs):
            awaited = {made_by[path] for path in job.inputs if path in made_by}
            self._awaited[number] = awaited
            for clip in awaited:
                self._waiting_for[clip].append(number)
            if not awaited:
                self._ready.append(number)

    def next(self) -> int | None:
        """Return the first job that is ready, and remove it; None if there is none."""
        return heapq.heappop(self._ready) if self._ready else None

    def succeeded(self, number: int) -> None:
        """Release the jobs that waited only for this one."""
        for waiting in self._waiting_for.pop(number, []):
            self._awaited[waiting].discard(number)
            if not self._awaited[waiting]:
                heapq.heappush(self._ready, waiting)

    def failed(self, number: int) -> list[int]:
        """Return the jobs that can no longer be done; they will not be started."""
        blocked = self._waiting_for.pop(number, [])
        for waiting in blocked:
            for clip in self._awaited.pop(waiting):
                if clip != number:
                    self._waiting_for[clip].remove(waiting)
        return blocked


@dataclass(frozen=True, eq=False)
class _Worker:
    """A process and the pipe to it."""

    process: SpawnProcess
    pipe: Connection

    @classmethod
    def started(cls) -> Self:
        """Start a process that waits for jobs."""
        context = multiprocessing.get_context("spawn")
        own_end, worker_end = context.Pipe()
        process = context.Process(target=work, args=(worker_end,), daemon=True)
        with _environment(ONE_THREAD):
            process.start()
        worker_end.close()
        return cls(process, own_end)

    def bury(self) -> str:
        """Clean up after a dead process; return how it ended."""
        self.process.join(_END_TIMEOUT)
        self.pipe.close()
        code = self.process.exitcode
        return f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"


class LocalWorkers:
    """Up to `processes` processes; each is started when it is first needed.

    All are ended at the end of the ``with`` block, even after an exception.
    """

    def __init__(self, processes: int) -> None:
        self._processes = max(1, processes)
        self._idle: list[_Worker] = []
        self._busy: dict[Connection, tuple[_Worker, int, Job]] = {}
        self._deaths: Counter[int] = Counter()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        workers = [*self._idle, *(worker for worker, _, _ in self._busy.values())]
        for worker in workers:
            worker.process.terminate()
            worker.pipe.close()
        for worker in workers:
            worker.process.join(_END_TIMEOUT)
            if worker.process.is_alive():
                worker.process.kill()

    def room(self) -> bool:
        """Return whether a process is idle, or may still be started."""
        return len(self._busy) < self._processes

    def begin(self, number: int, job: Job) -> None:
        """Give `job` to an idle process, or to a new one."""
        while self._idle:
            worker = self._idle[-1]
            # Busy before it is no longer idle, so that `__exit__` always finds it.
            self._busy[worker.pipe] = worker, number, job
            self._idle.pop()
            try:
                worker.pipe.send(job)
            except ConnectionError:  # it died while it was idle
                del self._busy[worker.pipe]
                worker.bury()
            else:
                return
        self._begin_in_new_process(number, job)

    def _begin_in_new_process(self, number: int, job: Job) -> None:
        worker = _Worker.started()
        self._busy[worker.pipe] = worker, number, job
        with suppress(ConnectionError):  # if it died at once, `ended` notices
            worker.pipe.send(job)

    def ended(self) -> Sequence[tuple[int, Outcome]]:
        """Wait until at least one job has ended, and return those that have."""
        ended: list[tuple[int, Outcome]] = []
        while not ended:
            ready = wait(list(self._busy))
            for pipe in [pipe for pipe in self._busy if pipe in ready]:
                worker, number, job = self._busy[pipe]
                try:
                    outcome: Outcome = pipe.recv()
                except (EOFError, ConnectionError):
                    del self._busy[pipe]
                    reason = worker.bury()
                    self._deaths[number] += 1
                    if self._deaths[number] < _ATTEMPTS:
                        self._begin_in_new_process(number, job)
                        continue
                    outcome = Outcome(
                        name=job.name,
                        error=f"the rendering process ended early, {_ATTEMPTS} times ({reason})",
                    )
                else:
                    self._idle.append(worker)
                    del self._busy[pipe]
                ended.append((number, outcome))
        return ended


@contextmanager
def _environment(changes: dict[str, str]) -> Iterator[None]:
    """Set environment variables during the block."""
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
    """Do the jobs from `pipe`, one after the other, until it is closed."""
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
