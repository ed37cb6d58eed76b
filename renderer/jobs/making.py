"""Making many videos: by processes of this machine, or by a cluster.

A job that fails, or takes its process down with it again and again, is reported; the others go
on.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from renderer.jobs.job import ClipJob, Job, Outcome
from renderer.jobs.local_workers import LocalWorkers

if TYPE_CHECKING:
    from renderer.jobs.cluster import ClusterWorkers


class JobOrder:
    """The jobs of one run, by their number in the order they were given.

    A pair whose clip is among the jobs waits for it, and so does a clip that gets another speech;
    existing clips are not waited for.
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
        """Return the first job that may be begun, and count it as begun; None if there is none."""
        return heapq.heappop(self._ready) if self._ready else None

    def succeeded(self, number: int) -> None:
        """Release the jobs that waited only for this one."""
        for waiting in self._waiting_for.pop(number, []):
            self._awaited[waiting].discard(number)
            if not self._awaited[waiting]:
                heapq.heappush(self._ready, waiting)

    def failed(self, number: int) -> list[int]:
        """Return the jobs that can no longer be done; they will not be begun."""
        blocked = self._waiting_for.pop(number, [])
        for waiting in blocked:
            for clip in self._awaited.pop(waiting):
                if clip != number:
                    self._waiting_for[clip].remove(waiting)
        return blocked


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
        What to make. They are begun in this order, but none before its clips; give each
        segment's pairs right after its clips, and its frames are soon no longer needed.
    processes : int
        How many to do at once on this machine, at least 1.
    cluster : str or None
        Address of a Dask scheduler whose workers do the jobs instead.
    on_done : callable
        Called in this process with each outcome as it comes.

    Returns
    -------
    list of Outcome
        In the order of `jobs`. What needs a clip that failed is not tried.

    Raises
    ------
    InputError
        If the cluster cannot be used.
    KeyboardInterrupt
        When interrupted. Processes of this machine are ended first, and no half-written file is
        left; workers of a cluster finish the video they are at.
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
        return LocalWorkers(processes)
    # Imported here: Dask is an optional extra.
    from renderer.jobs.cluster import ClusterWorkers

    return ClusterWorkers(cluster, _required_files(jobs))


def _required_files(jobs: Sequence[Job]) -> list[Path]:
    """Return files by which to check that a machine sees the study; one speech is enough."""
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
            if outcome.error is None:
                order.succeeded(number)
            yield number, outcome
            if outcome.error is not None:
                for blocked in order.failed(number):
                    yield blocked, _blocked_outcome(jobs[blocked], jobs[number])


def _blocked_outcome(blocked: Job, clip: Job) -> Outcome:
    return Outcome(
        name=blocked.name, error=f"its clip {clip.name} could not be made", because_of=clip.name
    )
