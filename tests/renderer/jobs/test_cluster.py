import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import dask
import pytest
from distributed import LocalCluster

from motion.errors import InputError
from renderer.jobs import cluster
from renderer.jobs.making import run_jobs
from renderer.look import RENDERER_VERSION
from renderer.video_jobs import ClipJob, Job
from tests.renderer.jobs.sample_jobs import clips_and_pairs, killing_writers, pair_of, video_of

pytestmark = pytest.mark.slow

PATIENCE = 60.0


def _cluster(workers: int) -> LocalCluster:
    """Start a scheduler on loopback with workers, which are restarted when they die."""
    with dask.config.set({"distributed.scheduler.allowed-failures": 1}):
        return LocalCluster(  # type: ignore[no-untyped-call]
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address=":0",
            env={"LP_NUM_THREADS": "0"},
        )


@pytest.fixture(scope="module")
def cluster_of_two() -> Iterator[str]:
    """Return the address of a cluster of two workers."""
    with _cluster(2) as made:
        yield made.scheduler_address


@pytest.fixture(autouse=True)
def _time_for_workers_to_start(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_WORKER_TIMEOUT", PATIENCE)


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
    clip_job: ClipJob, monkeypatch: pytest.MonkeyPatch
) -> None:
    with _cluster(0) as made:
        with monkeypatch.context() as patch:
            patch.setattr(cluster, "_WORKER_TIMEOUT", 0.5)
            with pytest.raises(InputError, match=r"no worker.*Start some with .*dask worker tcp"):
                run_jobs([clip_job], processes=1, cluster=made.scheduler_address)
        made.scale(1)
        with pytest.raises(InputError, match=r"connection .* was lost.*resumes where it stopped"):
            run_jobs(
                clips_and_pairs(clip_job, 2),
                processes=1,
                cluster=made.scheduler_address,
                on_done=lambda outcome: made.close(),
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
