"""The process that runs one job of the desk: starts its command, stops it, records how it ended.

``python -m studyapp.desk.job_process FOLDER LOCK``, with the job's folder, and the descriptor of
the inherited lock, which the command inherits too: the study is busy as long as either lives.
"""

import ctypes
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from studyapp.desk import jobs
from studyapp.side_process import LESS_URGENT, available_processors

POLL_SECONDS: Final = 0.3

PR_SET_PDEATHSIG: Final = 1
"""See prctl(2)."""

STOPPING: Final = (
    (0.0, signal.SIGINT),
    (30.0, signal.SIGTERM),
    (40.0, signal.SIGKILL),
)
"""Signals to the command, each with the seconds after the request to stop."""


def main(arguments: Sequence[str]) -> int:
    """Run the job in a folder to its end."""
    folder, lock = Path(arguments[0]), int(arguments[1])
    lower_priority_of_session()
    # A server that a script started in the background ignores it, and so would its children.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    job = jobs.Job.model_validate_json((folder / jobs.DESCRIPTION).read_bytes())
    study = folder.parent.parent
    environment = {
        **os.environ,
        jobs.PROGRESS_FILE: str(folder / jobs.PROGRESS),
        jobs.RESEARCHER: job.by,
        # One processor stays free for participants' requests.
        jobs.PROCESSES: str(max(1, available_processors() - 1)),
        "PYTHONUNBUFFERED": "1",
    }
    process = subprocess.Popen(  # noqa: S603 - our own program
        jobs.command_line(job.command),
        cwd=study,
        env=environment,
        stdin=subprocess.DEVNULL,
        process_group=0,
        pass_fds=(lock,),
        preexec_fn=_end_with_parent if sys.platform == "linux" else None,
    )
    status = _wait(process, folder / jobs.STOP)
    if status == 0 and job.packed:
        packed = study / job.packed
        shutil.make_archive(str(folder / job.archive), "zip", packed.parent, packed.name)
    stopped_by = (folder / jobs.STOP).read_text("utf-8") if (folder / jobs.STOP).exists() else ""
    job.model_copy(
        update={"status": status, "ended_at": datetime.now(UTC), "stopped_by": stopped_by}
    ).write(folder)
    # Before this interpreter ends: the page already shows that another job may begin.
    os.close(lock)
    return 0


def lower_priority_of_session() -> None:
    """Let all processes of this session come after the server's.

    Linux may share the processors equally among sessions, whatever their processes' priorities
    (autogroup, see sched(7)). The session then has a quarter of a busy processor.
    """
    os.nice(LESS_URGENT)
    with suppress(OSError):
        Path("/proc/self/autogroup").write_text("5", encoding="ascii")


def _end_with_parent() -> None:
    """Interrupt the command if this process is killed: nobody could stop it then."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGINT)


def _wait(process: subprocess.Popen[bytes], stop: Path) -> int:
    """Wait for the command, stopping it once `stop` exists, and return its exit status."""
    stop_requested, signals = 0.0, list(STOPPING)
    while True:
        with suppress(subprocess.TimeoutExpired):
            status = process.wait(POLL_SECONDS)
            break
        if not stop_requested and stop.exists():
            stop_requested = time.monotonic()
        while stop_requested and signals and time.monotonic() >= stop_requested + signals[0][0]:
            os.killpg(process.pid, signals.pop(0)[1])
    # Processes that it started and left behind end too.
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
