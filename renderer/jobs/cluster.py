"""Rendering on a Dask cluster, named by the address of its scheduler.

Scheduler and workers need the same version of Motion Jury, the same paths to the study and the
body, and one thread per worker. Dask itself gives a dead worker's job to another one.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, Final, Self
from uuid import uuid4

from motion.errors import InputError
from renderer.jobs.doing import Stages, do_job
from renderer.look import RENDERER_VERSION
from renderer.video_jobs import Job, Outcome

if TYPE_CHECKING:
    from distributed import Worker

START_COMMAND: Final = (
    "LP_NUM_THREADS=0 MALLOC_TRIM_THRESHOLD_=268435456 MALLOC_MMAP_THRESHOLD_=33554432 "
    "dask worker {address} --nthreads 1 --nworkers -1"
)
"""The command that starts workers. Dask's own malloc settings make rendering 10% slower."""

_CONNECT_TIMEOUT: Final = 8.0
_WORKER_TIMEOUT: Final = 10.0
_NO_WORKER_TIMEOUT: Final = 120.0
_POLL_INTERVAL: Final = 5.0
_LOWEST_PRIORITY: Final = -1e9


class ClusterWorkers:
    """The workers of one Dask cluster.

    Parameters
    ----------
    address : str
        Address of the scheduler, such as ``tcp://node1:8786``.
    required_files : sequence of Path
        Absolute paths of files and folders that every worker must see.
    """

    def __init__(self, address: str, required_files: Sequence[Path] = ()) -> None:
        self._address = address
        self._fitness = (RENDERER_VERSION, sys.version_info[:2], tuple(required_files))
        self._running: dict[str, tuple[int, Job, Any]] = {}
        self._ended: SimpleQueue[str] = SimpleQueue()
        # Dask also blames a worker's death on jobs that were waiting there, so each job is retried
        # once.
        self._retried: set[int] = set()
        self._client: Any = None

    def __enter__(self) -> Self:
        """Connect, and check every worker.

        Raises
        ------
        InputError
            If Dask is not installed, the address does not answer, or a worker is unsuitable.
        """
        self._client = _connected(self._address)
        try:
            self._check_workers()
        except BaseException:
            self._client.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """Cancel jobs that no worker has started; videos that are being written are finished."""
        if self._client.status == "running":
            self._client.cancel([future for _, _, future in self._running.values()])
        self._client.close()

    def room(self) -> bool:
        """Return whether a worker is idle; one job may always wait, since workers come and go."""
        self._check_connection()
        return len(self._running) < max(1, self._count_workers())

    def begin(self, number: int, job: Job) -> None:
        """Submit `job` to any worker."""
        self._submit(number, job, priority=-number)

    def _submit(self, number: int, job: Job, priority: float) -> None:
        future = self._client.submit(
            do_cluster_job,
            job,
            *self._fitness,
            key=f"{job.name}-{uuid4().hex}",
            priority=priority,
        )
        self._running[future.key] = (number, job, future)
        future.add_done_callback(lambda done: self._ended.put(done.key))

    def ended(self) -> Sequence[tuple[int, Outcome]]:
        """Wait until a job has ended, and return it.

        Raises
        ------
        InputError
            If the scheduler is gone, or all workers are gone for more than two minutes.
        """
        without_workers = 0.0
        while True:
            try:
                key = self._ended.get(timeout=_POLL_INTERVAL)
            except Empty:
                self._check_connection()
                without_workers = 0.0 if self._count_workers() else without_workers + _POLL_INTERVAL
                if without_workers > _NO_WORKER_TIMEOUT:
                    raise self._no_worker() from None
                continue
            self._check_connection()
            number, job, future = self._running.pop(key)
            if _killed(future) and number not in self._retried:
                self._retried.add(number)
                self._submit(number, job, priority=_LOWEST_PRIORITY)
                continue
            return [(number, _outcome_of(future, job))]

    def _check_workers(self) -> None:
        try:
            self._client.wait_for_workers(1, timeout=_WORKER_TIMEOUT)
        except TimeoutError:
            raise self._no_worker() from None
        answers = self._client.run(find_misfit, *self._fitness, on_error="return")
        unfit = {worker: reason for worker, reason in answers.items() if reason is not None}
        if unfit:
            worker, reason = next(iter(unfit.items()))
            raise InputError(
                f"{len(unfit)} of {len(answers)} workers cannot render; {worker}: {reason}",
                where=self._address,
                remedy="Give all machines the same Motion Jury and a shared folder, and start "
                f"workers with '{START_COMMAND.format(address=self._address)}'",
            )

    def _check_connection(self) -> None:
        if self._client.status != "running":
            raise self._connection_lost()

    def _count_workers(self) -> int:
        try:
            return len(self._client.scheduler_info()["workers"])
        except OSError:
            raise self._connection_lost() from None

    def _connection_lost(self) -> InputError:
        return InputError(
            "the connection to the cluster was lost",
            where=self._address,
            remedy="Start its scheduler again; the same command resumes where it stopped",
        )

    def _no_worker(self) -> InputError:
        return InputError(
            "the cluster has no workers",
            where=self._address,
            remedy=f"Start some with '{START_COMMAND.format(address=self._address)}'",
        )


def _connected(address: str) -> Any:
    """Return a client of the scheduler at `address`."""
    try:
        from distributed import Client
        from distributed.comm.addressing import resolve_address
    except ImportError:
        raise InputError(
            "Dask is not installed here",
            where="--cluster",
            remedy="Install it with: pip install 'motionjury[cluster]'",
        ) from None
    # A lost connection is reported as our error only, without Dask's tracebacks.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    client: Any = Client  # its methods carry no types
    try:
        # A client made for what is not an address hangs, and complains, when it is thrown away.
        resolve_address(address)
        return client(address, timeout=_CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(
            f"no Dask scheduler can be reached there ({error})",
            where=address,
            remedy="Start one with 'dask scheduler' and give the address it prints, such as "
            "tcp://node1:8786",
        ) from None


def _outcome_of(future: Any, job: Job) -> Outcome:
    """Return a worker's outcome of `job`, or that workers died over it."""
    if future.status == "finished":
        outcome: Outcome = future.result()
        return outcome
    if _killed(future):
        return Outcome(name=job.name, error="every worker that tried it ended early")
    problem = _problem(future)
    description = f"the cluster gave it up ({future.status})" if problem is None else repr(problem)
    return Outcome(name=job.name, error=f"the worker failed: {description}")


def _killed(future: Any) -> bool:
    """Return whether as many workers died on a job as Dask allows."""
    from distributed import KilledWorker

    return isinstance(_problem(future), KilledWorker)


def _problem(future: Any) -> BaseException | None:
    """Return a job's exception; None if there is none, or the job was lost or cancelled."""
    exception: BaseException | None = future.exception() if future.status == "error" else None
    return exception


def find_misfit(
    version: str, python: tuple[int, int], required_files: Sequence[Path], dask_worker: Worker
) -> str | None:
    """Return why this worker cannot render for this client; None if it can.

    Parameters
    ----------
    version : str
        The client's `RENDERER_VERSION`.
    python : tuple of int
        Major and minor version of the client's Python.
    required_files : sequence of Path
        Files and folders that must be reachable from here.
    dask_worker : Worker
        This worker; ``Client.run`` gives it to the parameter of this name.
    """
    if (version, python) != (RENDERER_VERSION, sys.version_info[:2]):
        return (
            f"it has another version (renderer {RENDERER_VERSION}, Python "
            f"{sys.version_info.major}.{sys.version_info.minor}; here {version}, "
            f"{python[0]}.{python[1]})"
        )
    threads = dask_worker.state.nthreads
    if threads != 1:
        return f"it does {threads} jobs at once in one process, which OpenGL does not allow"
    for path in required_files:
        if not path.exists():
            return f"it does not see {path}"
    return None


def do_cluster_job(
    job: Job, version: str, python: tuple[int, int], required_files: Sequence[Path]
) -> Outcome:
    """Do `job` if this worker, which may have joined late, is suitable."""
    from distributed import get_worker

    worker = get_worker()
    unfit = find_misfit(version, python, required_files, worker)
    if unfit is not None:
        return Outcome(name=job.name, error=f"worker {worker.address} cannot render: {unfit}")
    return do_job(job, _stages())


@cache
def _stages() -> Stages:
    """Return this process' stages, which last as long as the process."""
    return Stages()
