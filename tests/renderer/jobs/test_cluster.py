from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from motion.errors import InputError
from renderer.jobs import cluster
from renderer.jobs.making import run_jobs
from renderer.look import RENDERER_VERSION
from renderer.video_jobs import ClipJob, Job
from tests.renderer.jobs.sample_jobs import clips_and_pairs, killing_writers, pair_of, video_of

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[3]
PATIENCE = 60.0


def _dask(*arguments: str, log: Path) -> subprocess.Popen[bytes]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "LP_NUM_THREADS": "0"}
    environment["DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES"] = "1"
    with log.open("wb") as file:
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *arguments, "--no-dashboard"],
            stdout=file,
            stderr=file,
            env=environment,
            cwd=log.parent,
        )


@contextmanager
def _ended_afterwards(*processes: subprocess.Popen[bytes]) -> Iterator[None]:
    try:
        yield
    finally:
        for process in processes:
            process.terminate()
        for process in processes:
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


@contextmanager
def _scheduler(folder: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """Start a scheduler without workers on loopback; give its address and process."""
    described = folder / "scheduler.json"
    process = _dask(
        "scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(described),
        log=folder / "scheduler.log",
    )  # fmt: skip
    with _ended_afterwards(process):
        until = time.monotonic() + PATIENCE
        while not described.exists() or not described.read_text():
            assert time.monotonic() < until, (folder / "scheduler.log").read_text()
            time.sleep(0.1)
        yield json.loads(described.read_text())["address"], process


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the address of a scheduler that several tests use."""
    with _scheduler(tmp_path_factory.mktemp("scheduler")) as (address, _):
        yield address


@pytest.fixture(autouse=True)
def _time_for_workers_to_start(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_WORKER_TIMEOUT", PATIENCE)


@contextmanager
def _workers(address: str, folder: Path, *options: str, count: int) -> Iterator[None]:
    arguments = ("worker", address, "--nthreads", "1", "--host", "127.0.0.1", *options)
    started = [_dask(*arguments, log=folder / f"worker{number}.log") for number in range(count)]
    with _ended_afterwards(*started):
        yield


@pytest.fixture(scope="module")
def cluster_of_two(scheduler: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the address of a cluster of two workers, which are restarted when they die."""
    with _workers(scheduler, tmp_path_factory.mktemp("workers"), count=2):
        yield scheduler


def test_a_cluster_and_local_processes_make_the_same_files(
    cluster_of_two: str, clip_job: ClipJob, inputs: Path
) -> None:
    jobs = [
        *clips_and_pairs(clip_job, 2),
        replace(clip_job, name="mute", speech=inputs / "none.wav"),
    ]
    on_cluster = run_jobs(jobs, processes=1, cluster=cluster_of_two)
    contents = {job.name: video_of(job).read_bytes() for job in jobs[:4]}
    on_machine = run_jobs(jobs[:4], processes=2)
    assert [outcome.name for outcome in on_cluster] == [job.name for job in jobs]
    assert [outcome.error for outcome in on_cluster[:4] + on_machine] == [None] * 8
    assert "no such audio file" in str(on_cluster[4].error)
    assert contents == {job.name: video_of(job).read_bytes() for job in jobs[:4]}
    assert contents["clip0"] == contents["clip1"]


def test_a_clip_is_retried_until_it_has_killed_four_workers(
    cluster_of_two: str, clip_job: ClipJob, long_job: ClipJob, tmp_path: Path
) -> None:
    once = replace(long_job, name="once", frames=None, video=tmp_path / "once" / "once.mp4")
    with killing_writers(video_of(once).parent, times=1) as killed:
        (done,) = run_jobs([once], processes=1, cluster=cluster_of_two)
    assert (len(killed), done.error) == (1, None)
    assert video_of(once).exists()
    # Separately: Dask blames a worker's death on jobs that waited there too.
    jobs = [long_job, pair_of(long_job, "long pair"), *clips_and_pairs(clip_job, 1)]
    with killing_writers(video_of(long_job).parent, times=100) as killed:
        lost, pair, *rest = run_jobs(jobs, processes=1, cluster=cluster_of_two)
    assert len(killed) == 4
    assert "ended early" in str(lost.error)
    assert pair.because_of == "long"
    assert [outcome.error for outcome in rest] == [None, None]


def test_a_scheduler_without_workers_and_a_lost_one_are_reported(
    clip_job: ClipJob, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with _scheduler(tmp_path) as (address, process):
        with monkeypatch.context() as patch:
            patch.setattr(cluster, "_WORKER_TIMEOUT", 0.5)
            with pytest.raises(InputError, match=r"no worker.*Start some with .*dask worker tcp"):
                run_jobs([clip_job], processes=1, cluster=address)
        with (
            _workers(address, tmp_path, "--no-nanny", count=1),
            pytest.raises(InputError, match=r"connection .* was lost.*resumes where it stopped"),
        ):
            run_jobs(
                clips_and_pairs(clip_job, 2),
                processes=1,
                cluster=address,
                on_done=lambda outcome: process.kill(),
            )
    assert video_of(clip_job).with_stem("clip0").exists()


def test_unsuitable_workers_are_refused(
    cluster_of_two: str, clip_job: ClipJob, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pair, gone = pair_of(clip_job, "pair"), tmp_path / "gone.npz"
    without: list[list[Job]] = [
        [replace(clip_job, speech=gone)],
        [pair, replace(clip_job, body=gone)],
        [pair, replace(clip_job, look=replace(clip_job.look, expression_matrix=gone))],
    ]
    for lacking in without:
        with pytest.raises(InputError, match=r"2 of 2 workers cannot .* does not see .*gone"):
            run_jobs(lacking, processes=1, cluster=cluster_of_two)
    monkeypatch.setattr(cluster, "RENDERER_VERSION", "another")
    with pytest.raises(InputError, match=r"another version .*here another"):
        run_jobs([clip_job], processes=1, cluster=cluster_of_two)
    monkeypatch.undo()
    two_threads = SimpleNamespace(state=SimpleNamespace(nthreads=2))
    fitness: Any = (RENDERER_VERSION, sys.version_info[:2], (), two_threads)
    assert "does 2 jobs at once" in str(cluster.find_misfit(*fitness))


@pytest.mark.parametrize("address", ["", "nonsense", "http://node1", "tcp://127.0.0.1:1"])
def test_an_address_without_a_scheduler_is_refused(
    clip_job: ClipJob, address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "_CONNECT_TIMEOUT", 0.5)
    with pytest.raises(InputError, match="no Dask scheduler can be reached"):
        run_jobs([clip_job], processes=1, cluster=address)


def test_without_dask_the_error_gives_a_remedy(
    clip_job: ClipJob, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"pip install 'motionjury\[cluster\]'"):
        run_jobs([clip_job], processes=1, cluster="tcp://127.0.0.1:1")
