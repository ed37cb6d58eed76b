"""Jobs that really run, and waiting for them."""

import time
from datetime import UTC, datetime
from pathlib import Path

from studyapp.desk.jobs import Job, JobStanding, State, job_standings, run_job

SLOW = ("rehearse", "--speed", "1")
"""A command of the tiny study that takes minutes."""

PATIENCE = 300.0
"""Seconds; waiting ends as soon as it is over."""


def begin(jobs: Path, *command: str, kind: str = "try", packed: str = "") -> None:
    """Begin a job for Ada."""
    run_job(
        jobs, Job(kind=kind, command=command, by="Ada", began_at=datetime.now(UTC), packed=packed)
    )


def wait_for(jobs: Path, *states: State, kind: str = "try") -> JobStanding:
    """Wait until the job is in one of the states."""
    deadline = time.monotonic() + PATIENCE
    while (found := job_standings(jobs)[kind]).state not in states:
        assert time.monotonic() < deadline, found
        time.sleep(0.05)
    return found


def wait_until_under_way(jobs: Path, kind: str = "try") -> None:
    """Wait until the job's command has reported progress."""
    deadline = time.monotonic() + PATIENCE
    while (found := job_standings(jobs)[kind]).progress is None:
        assert time.monotonic() < deadline, found
        time.sleep(0.05)


def wait_until_ended(jobs: Path, kind: str = "try") -> JobStanding:
    """Wait until nothing of the job runs any more."""
    return wait_for(jobs, "done", "failed", "stopped", "interrupted", kind=kind)
