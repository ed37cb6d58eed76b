from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from renderer.framing import Camera
from renderer.job import ClipJob, Outcome, PairJob
from renderer.jobs import ONE_THREAD, run_jobs
from renderer.look import Look
from tests.renderer.conftest import SECONDS

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def clip_job(inputs: Path, body_path: Path, camera: Camera, tmp_path: Path) -> ClipJob:
    return ClipJob(
        name="clip",
        motion=inputs / "clip.npz",
        speech=inputs / "speech.wav",
        start=0.0,
        end=SECONDS,
        freeze=(),
        body=body_path,
        camera=camera,
        look=Look(size=64),
        frames=tmp_path / "clip.mkv",
        video=tmp_path / "clip.mp4",
    )


@pytest.fixture
def pair_job(clip_job: ClipJob, tmp_path: Path) -> PairJob:
    return PairJob(
        name="pair",
        left=clip_job.frames,
        right=clip_job.frames,
        speech=clip_job.speech,
        start=0.0,
        end=SECONDS,
        video=tmp_path / "pair.mp4",
        look=clip_job.look,
    )


def test_broken_jobs_are_reported_and_the_rest_goes_on(
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
    ]
    outcomes = run_jobs(jobs, processes=1, on_done=told.append)
    assert [outcome.name for outcome in outcomes] == ["lonely", "nan", "mute", "clip", "pair"]
    assert [outcome.error is None for outcome in outcomes] == [False, False, False, True, True]
    assert "not a number" in str(outcomes[1].error)
    assert str(tmp_path / "nan.npz") in str(outcomes[1].error)
    assert "no such audio file" in str(outcomes[2].error)
    assert {outcome.name for outcome in told} == {outcome.name for outcome in outcomes}
    assert clip_job.video.exists()
    assert pair_job.video.exists()
    assert not (tmp_path / "nan.mp4").exists()


def test_a_job_that_kills_its_process_is_reported_and_the_rest_goes_on(
    clip_job: ClipJob, tmp_path: Path
) -> None:
    def end_the_workers(outcome: Outcome) -> None:
        if outcome.name == "first":
            for pid in _children():
                os.kill(pid, signal.SIGKILL)

    jobs = [
        replace(clip_job, name="first"),
        replace(clip_job, name="second", end=SECONDS - 0.01, video=tmp_path / "second.mp4"),
        replace(clip_job, name="third", video=tmp_path / "third.mp4"),
    ]
    first, second, third = run_jobs(jobs, processes=1, on_done=end_the_workers)
    assert first.error is None
    assert "ended early (signal 9)" in str(second.error)
    assert third.error is None
    assert (tmp_path / "third.mp4").exists()


def _children() -> list[int]:
    """Return the processes that this one started through multiprocessing."""
    import multiprocessing

    return [child.pid for child in multiprocessing.active_children() if child.pid]


def test_two_processes_make_what_one_makes(clip_job: ClipJob, tmp_path: Path) -> None:
    jobs = [
        replace(
            clip_job,
            name=str(number),
            frames=tmp_path / f"{number}.mkv",
            video=tmp_path / f"{number}.mp4",
        )
        for number in range(3)
    ]
    assert all(outcome.error is None for outcome in run_jobs(jobs, processes=2))
    contents = {job.video.read_bytes() for job in jobs}
    assert len(contents) == 1


def test_a_worker_draws_and_computes_in_one_thread() -> None:
    assert ONE_THREAD["LP_NUM_THREADS"] == "0"
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    run_jobs([], processes=2)
    assert before == {name: os.environ.get(name) for name in ONE_THREAD}


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
import pickle, sys
from renderer.jobs import run_jobs
if __name__ == "__main__":
    jobs = pickle.loads(open(sys.argv[1], "rb").read())
    run_jobs(jobs, processes=1, on_done=lambda outcome: print(outcome.name, flush=True))
"""


def test_ctrl_c_ends_all_processes_and_leaves_no_half_written_file(
    clip_job: ClipJob, tmp_path: Path
) -> None:
    import pickle

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
    for _ in range(50):
        if not _running_in_group(process.pid):
            break
        time.sleep(0.1)
    assert _running_in_group(process.pid) == []
    assert {path.name for path in tmp_path.iterdir()} == {
        "clip.mkv", "clip.mp4", "jobs.pickle", "endless.py",
    }  # fmt: skip
