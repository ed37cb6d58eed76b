"""The process that runs one job of the desk: begins its command, stops it, tells how it ended.

``python -m studyapp.desk.job_process FOLDER LOCK``, with the job's folder, and the descriptor of
the lock that it has inherited and hands on: the study is busy as long as either of them lives.
"""

from __future__ import annotations

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

from studyapp.desk.jobs import (
    DESCRIPTION,
    PROGRESS,
    PROGRESS_FILE,
    RESEARCHER,
    STOP,
    Job,
    command_line,
)
from studyapp.side_process import LESS_URGENT

LOOKS_EVERY: Final = 0.3
"""Seconds."""

STOPPING: Final = (
    (0.0, signal.SIGINT),
    (30.0, signal.SIGTERM),
    (40.0, signal.SIGKILL),
)
"""What the command is sent, and how many seconds after it was asked to stop."""


def main(arguments: Sequence[str]) -> int:
    """Run the job in a folder to its end."""
    own, lock = Path(arguments[0]), int(arguments[1])
    os.nice(LESS_URGENT)
    # A server that a script began in the background ignores it, and so would all that it begins.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    job = Job.model_validate_json((own / DESCRIPTION).read_bytes())
    study = own.parent.parent
    environment = {
        **os.environ,
        PROGRESS_FILE: str(own / PROGRESS),
        RESEARCHER: job.by,
        "PYTHONUNBUFFERED": "1",
    }
    process = subprocess.Popen(  # noqa: S603 - our own program
        command_line(job.command),
        cwd=study,
        env=environment,
        stdin=subprocess.DEVNULL,
        process_group=0,
        pass_fds=(lock,),
    )
    status = _ended(process, own / STOP)
    if status == 0 and job.packed:
        packed = study / job.packed
        shutil.make_archive(str(own / job.archive), "zip", packed.parent, packed.name)
    stopped_by = (own / STOP).read_text("utf-8") if (own / STOP).exists() else ""
    job.model_copy(
        update={"status": status, "ended_at": datetime.now(UTC), "stopped_by": stopped_by}
    ).write(own)
    return 0


def _ended(process: subprocess.Popen[bytes], stop: Path) -> int:
    """Wait for the command, stopping it if that is asked for, and return its exit status."""
    asked, due = 0.0, list(STOPPING)
    while True:
        with suppress(subprocess.TimeoutExpired):
            status = process.wait(LOOKS_EVERY)
            break
        if not asked and stop.exists():
            asked = time.monotonic()
        while asked and due and time.monotonic() >= asked + due[0][0]:
            os.killpg(process.pid, due.pop(0)[1])
    # What it has begun itself, and left behind, ends too.
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
