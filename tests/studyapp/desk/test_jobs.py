"""Jobs are independent commands, and their state is reported correctly whatever happens."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.desk.jobs import PROCESSES, job_log, job_standings, stop_job
from tests.studyapp.desk.job_watching import (
    PATIENCE,
    SLOW,
    begin,
    wait_for,
    wait_until_ended,
    wait_until_under_way,
)


@pytest.fixture
def jobs(tiny_study: Path) -> Path:
    return tiny_study / "jobs"


def processes_of(study: Path) -> list[int]:
    """Return the processes that run a job's command in a study, and those that it has begun."""
    processes = []
    for place in Path("/proc").glob("[0-9]*/cwd"):
        try:
            if place.readlink() == study:
                processes.append(int(place.parent.name))
        except OSError:
            continue
    return processes


def wait_until_no_process_is_left(study: Path) -> None:
    """Wait until the processes are gone; jobs end a moment before their processes."""
    deadline = time.monotonic() + PATIENCE
    while left := processes_of(study):
        assert time.monotonic() < deadline, left
        time.sleep(0.05)


def test_a_job_outlives_its_server_allows_no_other_and_can_be_stopped(
    jobs: Path, tiny_study: Path
) -> None:
    code = (
        "import os, signal, sys; from pathlib import Path; "
        "from tests.studyapp.desk.job_watching import SLOW, begin; "
        # As in a script's background.
        "signal.signal(signal.SIGINT, signal.SIG_IGN); "
        "begin(Path(sys.argv[1]), *SLOW); os.killpg(0, signal.SIGKILL)"
    )
    server = subprocess.run([sys.executable, "-c", code, str(jobs)], process_group=0, check=False)
    assert server.returncode == -signal.SIGKILL
    assert wait_for(jobs, "running").job.by == "Ada"
    with pytest.raises(InputError, match="another job"):
        begin(jobs, "check", kind="other")
    assert list(job_standings(jobs)) == ["try"]
    # Before its first progress, the command may not have replaced the process it forked from.
    wait_until_under_way(jobs)
    left = f"{PROCESSES}={max(1, len(os.sched_getaffinity(0)) - 1)}\0".encode()
    for process in processes_of(tiny_study):
        assert left in Path(f"/proc/{process}/environ").read_bytes()
        assert os.getpriority(os.PRIO_PROCESS, process) >= 10
        group = Path(f"/proc/{process}/autogroup")
        assert not group.exists() or group.read_text().endswith("nice 5\n")
    stop_job(jobs, "try", by="Grace")
    assert job_standings(jobs)["try"].state in ("stopping", "stopped")
    standing = wait_until_ended(jobs)
    assert (standing.state, standing.job.stopped_by) == ("stopped", "Grace")
    with pytest.raises(InputError, match="not running"):
        stop_job(jobs, "try", by="Grace")
    assert "Run the same command again to continue" in job_log(jobs, "try", most=10_000)
    wait_until_no_process_is_left(tiny_study)


def test_a_job_whose_supervisor_is_killed_is_interrupted_and_blocks_no_other_which_may_fail(
    jobs: Path, tiny_study: Path
) -> None:
    begin(jobs, *SLOW)
    wait_until_under_way(jobs)
    running = processes_of(tiny_study)
    (supervisor,) = {_parent(each) for each in running} - set(running)
    os.kill(supervisor, signal.SIGKILL)
    assert wait_until_ended(jobs).state == "interrupted"
    # The study was busy until its command had left everything in order.
    assert "Run the same command again to continue" in job_log(jobs, "try", most=10_000)
    wait_until_no_process_is_left(tiny_study)
    begin(jobs, "nothing", kind="other", packed="speech")
    standing = wait_until_ended(jobs, "other")
    assert (standing.state, standing.job.status) == ("failed", 2)
    assert "No such command 'nothing'" in job_log(jobs, "other", most=10_000)
    assert not (jobs / "other" / "speech.zip").exists()
    (jobs / "other" / "job.json").write_text('{"kind": "of another version", "pid": 3}')
    (left,) = job_standings(jobs).values()
    assert left.state == "interrupted"


def _parent(process: int) -> int:
    return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])
