"""What a worker of a Dask cluster is asked to do."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from distributed import Worker, get_worker

from renderer.jobs.job import Job, Outcome
from renderer.jobs.worker import Stages, do_job
from renderer.version import RENDERER_VERSION


def why_unfit(
    version: str, python: tuple[int, int], needed: Sequence[Path], dask_worker: Worker
) -> str | None:
    """Return why this worker cannot render for the one who asks; None where it can.

    Parameters
    ----------
    version : str
        `RENDERER_VERSION` of the one who asks.
    python : tuple of int
        Major and minor version of their Python.
    needed : sequence of Path
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
    for path in needed:
        if not path.exists():
            return f"it does not see {path}"
    return None


def do_cluster_job(
    job: Job, version: str, python: tuple[int, int], needed: Sequence[Path]
) -> Outcome:
    """Do `job` if this worker, which may have joined late, is fit for it."""
    worker = get_worker()
    unfit = why_unfit(version, python, needed, worker)
    if unfit is not None:
        return Outcome(name=job.name, error=f"worker {worker.address} was left: {unfit}")
    return do_job(job, _stages())


@cache
def _stages() -> Stages:
    """Return this process's one stage; it ends with the process."""
    return Stages()
