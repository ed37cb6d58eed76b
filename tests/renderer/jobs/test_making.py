from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from renderer.jobs.job import ClipJob, Outcome, PairJob
from renderer.jobs.local_workers import ONE_THREAD
from renderer.jobs.making import run_jobs
from tests.renderer.jobs.sample_jobs import killing_writers, numbered, pair_of

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def pair_job(clip_job: ClipJob) -> PairJob:
    return pair_of(clip_job, "pair")


def test_broken_jobs_are_reported_and_the_rest_goes_on_in_order_in_one_thread(
    clip_job: ClipJob, pair_job: PairJob, inputs: Path, tmp_path: Path
) -> None:
    with np.load(inputs / "clip.npz") as archive:
        arrays = dict(archive)
    arrays["poses"] = arrays["poses"].copy()
    arrays["poses"][3] = np.nan
    np.savez(tmp_path / "nan.npz", **arrays)
    told: list[Outcome] = []
    jobs = [
        replace(pair_job, name="lonely", left=tmp_path / "never.mkv"),
        replace(clip_job, name="nan", motion=tmp_path / "nan.npz", video=tmp_path / "nan.mp4"),
        replace(clip_job, name="mute", speech=tmp_path / "none.wav", video=tmp_path / "mute.mp4"),
        clip_job,
        pair_job,
        replace(clip_job, name="next", frames=tmp_path / "2.mkv", video=tmp_path / "2.mp4"),
    ]
    assert ONE_THREAD["LP_NUM_THREADS"] == "0"
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    outcomes = run_jobs(jobs, processes=1, on_done=told.append)
    assert before == {name: os.environ.get(name) for name in ONE_THREAD}
    names = ["lonely", "nan", "mute", "clip", "pair", "next"]
    assert [outcome.name for outcome in outcomes] == names
    assert [outcome.name for outcome in told] == ["nan", "mute", "clip", "lonely", "pair", "next"]
    assert [outcome.error is None for outcome in outcomes] == [False] * 3 + [True] * 3
    assert "not a number" in str(outcomes[1].error)
    assert str(tmp_path / "nan.npz") in str(outcomes[1].error)
    assert "no such audio file" in str(outcomes[2].error)
    assert clip_job.video.exists()
    assert pair_job.video.exists()
    assert not (tmp_path / "nan.mp4").exists()


@pytest.mark.slow
def test_the_job_of_a_killed_process_is_done_by_another(
    long_job: ClipJob, clip_job: ClipJob
) -> None:
    with killing_writers(long_job.video.parent, times=1) as killed:
        outcomes = run_jobs([long_job, clip_job], processes=2)
    assert len(killed) == 1
    assert [outcome.error for outcome in outcomes] == [None, None]
    assert long_job.video.exists()
    assert long_job.frames.exists()


@pytest.mark.slow
def test_a_job_that_kills_two_processes_is_reported_and_the_rest_goes_on(
    long_job: ClipJob, clip_job: ClipJob, pair_job: PairJob
) -> None:
    doomed_pair = replace(pair_job, name="doomed pair", right=long_job.frames)
    with killing_writers(long_job.video.parent, times=100) as killed:
        lost, first, doomed, pair = run_jobs(
            [long_job, clip_job, doomed_pair, pair_job], processes=1
        )
    assert len(killed) == 2
    assert "ended early, 2 times (signal 9)" in str(lost.error)
    assert (doomed.because_of, doomed.error) == ("long", "its clip long could not be made")
    assert (first.error, pair.error) == (None, None)
    assert not long_job.video.exists()
    assert pair_job.video.exists()


@pytest.mark.slow
def test_a_process_that_dies_while_it_is_idle_costs_no_job(
    clip_job: ClipJob, tmp_path: Path
) -> None:
    def end_the_workers(outcome: Outcome) -> None:
        for child in multiprocessing.active_children():
            child.kill()
            child.join()

    jobs = [
        replace(clip_job, name=str(number), video=tmp_path / f"{number}.mp4") for number in range(2)
    ]
    outcomes = run_jobs(jobs, processes=1, on_done=end_the_workers)
    assert [outcome.error for outcome in outcomes] == [None, None]


def test_two_processes_make_what_one_makes(clip_job: ClipJob, tmp_path: Path) -> None:
    jobs = [numbered(clip_job, number) for number in range(3)]
    assert all(outcome.error is None for outcome in run_jobs(jobs, processes=2))
    contents = {job.video.read_bytes() for job in jobs}
    assert len(contents) == 1


def test_no_jobs_are_done_at_once() -> None:
    assert run_jobs([], processes=1) == []


def _running_in_group(group: int) -> list[str]:
    """Return the states of the group's processes, ended ones left out, from Linux's /proc."""
    states = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, its_group = stat.read_text().rpartition(")")[2].split()[:3]
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(its_group) == group and state != "Z":
            states.append(f"{stat.parent.name} {state}")
    return states


_ENDLESS = """
import pickle, signal, sys
from renderer.jobs.making import run_jobs
if __name__ == "__main__":
    # Where tests run in the background, Ctrl-C is ignored until somebody asks for it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    jobs = pickle.loads(open(sys.argv[1], "rb").read())
    run_jobs(jobs, processes=1, on_done=lambda outcome: print(outcome.name, flush=True))
"""


def test_ctrl_c_ends_all_processes_and_leaves_no_half_written_file(
    clip_job: ClipJob, tmp_path: Path
) -> None:
    jobs = [replace(clip_job, name=str(number)) for number in range(1000)]
    (tmp_path / "jobs.pickle").write_bytes(pickle.dumps(jobs))
    script = tmp_path / "endless.py"
    script.write_text(_ENDLESS)
    process = subprocess.Popen(
        [sys.executable, str(script), str(tmp_path / "jobs.pickle")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        start_new_session=True,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "0\n"
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert "KeyboardInterrupt" in errors
    for _ in range(600):
        if not _running_in_group(process.pid):
            break
        time.sleep(0.1)
    assert _running_in_group(process.pid) == []
    assert {path.name for path in tmp_path.iterdir()} == {
        "clip.mkv", "clip.mp4", "jobs.pickle", "endless.py",
    }  # fmt: skip
