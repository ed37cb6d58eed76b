"""Making many videos: by processes of this machine, or by a cluster.

A job that fails, or takes its process down with it again and again, is reported; the others go
on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from renderer.jobs.job import ClipJob, Job, Outcome
from renderer.jobs.job_order import JobOrder
from renderer.jobs.local_workers import LocalWorkers
from renderer.jobs.workers import Workers


def run_jobs(
    jobs: Sequence[Job],
    *,
    processes: int,
    cluster: str | None = None,
    on_done: Callable[[Outcome], None] = lambda outcome: None,
) -> list[Outcome]:
    """Do all `jobs`; a broken one is reported and the rest goes on.

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
        for number, outcome in _done_in_order(jobs, workers):
            outcomes[number] = outcome
            on_done(outcome)
    return [outcomes[number] for number in range(len(jobs))]


def _workers(jobs: Sequence[Job], processes: int, cluster: str | None) -> Workers:
    if cluster is None:
        return LocalWorkers(processes)
    # Imported here: Dask is an optional extra.
    from renderer.jobs.cluster import ClusterWorkers

    return ClusterWorkers(cluster, _needed_files(jobs))


def _needed_files(jobs: Sequence[Job]) -> list[Path]:
    """Return what tells whether a machine sees the study: all share a body, one speech will do."""
    clips = [job for job in jobs if isinstance(job, ClipJob)]
    needed = {jobs[0].speech, *(job.body for job in clips)}
    needed |= {job.look.expression_matrix for job in clips}
    return sorted(path for path in needed if path is not None)


def _done_in_order(jobs: Sequence[Job], workers: Workers) -> Iterator[tuple[int, Outcome]]:
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
                for lost in order.failed(number):
                    yield lost, _impossible(jobs[lost], jobs[number])


def _impossible(lost: Job, clip: Job) -> Outcome:
    return Outcome(
        name=lost.name, error=f"its clip {clip.name} could not be made", because_of=clip.name
    )
