"""Commands that the desk runs: one at a time for each study, known from the study's folder alone.

A job is a command of the command line in processes of its own, which go on without the page and the
server that began it. It runs as long as its processes hold a lock, which ends with them however
they end; everything else is in the folder ``jobs/<kind>``, which keeps the last job of each kind.
So every process of the server, and a server that is restarted, sees the same.
"""

import fcntl
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from pydantic import AwareDatetime, BaseModel, ConfigDict, ValidationError

from motion.errors import InputError
from motion.files import write_text

DESCRIPTION: Final = "job.json"
LOG: Final = "log.txt"
PROGRESS: Final = "progress.json"
STOP: Final = "stop.txt"
"""Holds the name of the researcher who asks the job to stop."""

PROGRESS_FILE: Final = "MOTIONJURY_PROGRESS"
"""The environment variable that names the file in which a command reports its progress."""

PROCESSES: Final = "MOTIONJURY_PROCESSES"
"""The environment variable with the number of processes that a command starts by default."""

RESEARCHER: Final = "MOTIONJURY_RESEARCHER"
"""The environment variable that names who runs a command, for the log of looks."""

PROGRAM: Final = "studyapp.desk.job_process"
LOCK_SECONDS: Final = 1.0
"""For how long to try for a lock that others take for a moment to look."""

State = Literal["running", "stopping", "done", "failed", "stopped", "interrupted"]


class Job(BaseModel):
    """A command that was begun.

    Attributes
    ----------
    command : tuple of str
        The arguments of ``motionjury``; it is run in the study's folder.
    by : str
        The researcher's name.
    packed : str
        A folder within the study's that becomes an archive when the command has succeeded;
        empty for none.
    status : int or None
        The command's exit status; None until it ends, and if that was not recorded.
    stopped_by : str
        The name of the researcher who stopped it; empty if nobody did.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: str
    command: tuple[str, ...]
    by: str
    began_at: AwareDatetime
    packed: str = ""
    ended_at: AwareDatetime | None = None
    status: int | None = None
    stopped_by: str = ""

    def write(self, folder: Path) -> None:
        """Write it into the job's own folder."""
        write_text(folder / DESCRIPTION, self.model_dump_json(indent=1))

    @property
    def archive(self) -> str:
        """The name of the archive, without an ending."""
        return Path(self.packed).name


class Progress(BaseModel):
    """How far a command is.

    Attributes
    ----------
    done, total : int
        How far it is, in whatever it counts.
    words : str
        The same for people, with the time that is left.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    done: int
    total: int
    words: str


@dataclass(frozen=True, kw_only=True)
class JobStanding:
    """The last job of its kind, and how it stands.

    Attributes
    ----------
    progress : Progress or None
        None before the command has reported any, and once it has ended.
    """

    job: Job
    state: State
    progress: Progress | None = None

    @property
    def is_running(self) -> bool:
        """Whether no other job can begin."""
        return self.state in ("running", "stopping")


def run_job(jobs: Path, job: Job) -> None:
    """Begin a job, which goes on after this returns.

    Parameters
    ----------
    jobs : Path
        The folder of jobs in the study's folder.

    Raises
    ------
    InputError
        If another job of the study runs.
    """
    folder = jobs / job.kind
    with no_other_job(jobs) as lock:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        job.write(folder)
        with (folder / LOG).open("wb") as log:
            # Without -P, a folder with the name of a package would be imported in its place.
            process = subprocess.Popen(  # noqa: S603 - our own program
                [sys.executable, "-P", "-m", PROGRAM, str(folder), str(lock)],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                pass_fds=(lock,),
            )
    # Else the process remains as a zombie when it has ended.
    threading.Thread(target=process.wait, name="job", daemon=True).start()


@contextmanager
def no_other_job(jobs: Path) -> Iterator[int]:
    """Give the lock of a study's jobs; processes that inherit it go on holding it.

    Raises
    ------
    InputError
        If a job of the study runs.
    """
    jobs.mkdir(exist_ok=True)
    lock = os.open(jobs, os.O_RDONLY)
    try:
        deadline = time.monotonic() + LOCK_SECONDS
        while True:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > deadline:
                    raise InputError(
                        "another job of this study is running",
                        remedy="Wait until it is done, or stop it",
                    ) from None
                time.sleep(0.02)
        yield lock
    finally:
        os.close(lock)


def stop_job(jobs: Path, kind: str, *, by: str) -> None:
    """Ask the job of a kind to stop; it takes a while to leave everything in order.

    Raises
    ------
    InputError
        If none runs.
    """
    standing = job_standings(jobs).get(kind)
    if standing is None or not standing.is_running:
        raise InputError("this job is not running any more", remedy="See how it ended")
    write_text(jobs / kind / STOP, by)


def job_standings(jobs: Path) -> Mapping[str, JobStanding]:
    """Return the last job of each kind that was ever begun."""
    last_jobs = [job for path in jobs.glob(f"*/{DESCRIPTION}") if (job := _read(path)) is not None]
    latest = max(last_jobs, key=lambda job: job.began_at, default=None)
    # Only the latest can hold the lock, unless it has just ended.
    has_lock = latest is not None and latest.status is None and _is_locked(jobs)
    return {
        job.kind: _standing(jobs / job.kind, job, is_running=has_lock and job is latest)
        for job in last_jobs
    }


def _read(path: Path) -> Job | None:
    """Return a job; None if there is none, or it was written by another version."""
    try:
        return Job.model_validate_json(path.read_bytes())
    except (OSError, ValidationError):
        return None


def _is_locked(jobs: Path) -> bool:
    lock = os.open(jobs, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(lock)
    return False


def _standing(folder: Path, job: Job, *, is_running: bool) -> JobStanding:
    if is_running:
        progress = None
        with suppress(OSError, ValidationError):
            progress = Progress.model_validate_json((folder / PROGRESS).read_bytes())
        state: State = "stopping" if (folder / STOP).exists() else "running"
        return JobStanding(job=job, state=state, progress=progress)
    if job.status is None:
        # It may have ended between two looks.
        job = _read(folder / DESCRIPTION) or job
    if job.status is None:
        state = "interrupted"
    elif job.status == 0:
        state = "done"
    else:
        state = "stopped" if job.stopped_by else "failed"
    return JobStanding(job=job, state=state)


def job_log(jobs: Path, kind: str, *, most: int) -> str:
    """Return the last `most` bytes of what the job of a kind has printed."""
    try:
        with (jobs / kind / LOG).open("rb") as log:
            size = log.seek(0, os.SEEK_END)
            log.seek(max(0, size - most))
            return log.read().decode("utf-8", "replace")
    except OSError:
        return ""


def command_line(command: Sequence[str]) -> list[str]:
    """Return the arguments that start the command line."""
    return [sys.executable, "-P", "-m", "studyapp.cli.main", *command]
