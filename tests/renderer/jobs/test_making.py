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
from hypothesis import given
from hypothesis import strategies as st

from renderer.jobs.making import ONE_THREAD, JobOrder, run_jobs
from renderer.video_jobs import ClipJob, DubJob, Job, Outcome, PairJob
from tests.renderer.jobs.sample_jobs import frames_of, killing_writers, numbered, pair_of, video_of

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def pair_job(clip_job: ClipJob) -> PairJob:
    return pair_of(clip_job, "pair")


def test_failed_jobs_are_reported_and_the_rest_runs_in_order_in_one_thread(
    clip_job: ClipJob, pair_job: PairJob, inputs: Path, tmp_path: Path
) -> None:
    with np.load(inputs / "clip.npz") as archive:
        arrays = dict(archive)
    arrays["poses"] = arrays["poses"].copy()
    arrays["poses"][3] = np.nan
    np.savez(tmp_path / "nan.npz", **arrays)
    done: list[Outcome] = []
    jobs: list[Job] = [
        replace(pair_job, name="lonely", left=tmp_path / "never.mkv"),
        replace(clip_job, name="nan", motion=tmp_path / "nan.npz", video=tmp_path / "nan.mp4"),
        replace(clip_job, name="mute", speech=tmp_path / "none.wav", video=tmp_path / "mute.mp4"),
        clip_job,
        pair_job,
        replace(clip_job, name="next", frames=tmp_path / "2.mkv", video=tmp_path / "2.mp4"),
    ]
    assert ONE_THREAD["LP_NUM_THREADS"] == "0"
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    outcomes = run_jobs(jobs, processes=1, on_done=done.append)
    assert before == {name: os.environ.get(name) for name in ONE_THREAD}
    names = ["lonely", "nan", "mute", "clip", "pair", "next"]
    assert [outcome.name for outcome in outcomes] == names
    assert [outcome.name for outcome in done] == ["nan", "mute", "clip", "lonely", "pair", "next"]
    assert [outcome.error is None for outcome in outcomes] == [False] * 3 + [True] * 3
    assert "holds nan at" in str(outcomes[1].error)
    assert str(tmp_path / "nan.npz") in str(outcomes[1].error)
    assert "no such audio file" in str(outcomes[2].error)
    assert video_of(clip_job).exists()
    assert video_of(pair_job).exists()
    assert not (tmp_path / "nan.mp4").exists()


@pytest.mark.slow
def test_a_job_is_retried_until_it_has_killed_two_processes(
    long_job: ClipJob, clip_job: ClipJob, pair_job: PairJob, tmp_path: Path
) -> None:
    once = replace(long_job, name="once", frames=None, video=tmp_path / "once" / "once.mp4")
    doomed_pair = replace(pair_job, name="doomed pair", right=frames_of(long_job))
    jobs: list[Job] = [once, long_job, clip_job, doomed_pair, pair_job]
    with (
        killing_writers(video_of(once).parent, times=1) as killed_once,
        killing_writers(video_of(long_job).parent, times=100) as killed,
    ):
        done, lost, first, doomed, pair = run_jobs(jobs, processes=1)
    assert (len(killed_once), len(killed)) == (1, 2)
    assert (done.error, first.error, pair.error) == (None, None, None)
    assert video_of(once).exists()
    assert "ended early, 2 times (signal 9)" in str(lost.error)
    assert (doomed.because_of, doomed.error) == ("long", "its clip long could not be made")
    assert not video_of(long_job).exists()
    assert video_of(pair_job).exists()


def test_without_graphics_no_process_is_started(
    job: ClipJob, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyrender", None)
    with pytest.raises(ModuleNotFoundError, match="pyrender"):
        run_jobs([job], processes=1)
    assert not multiprocessing.active_children()


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
    # If tests run in the background, Ctrl-C is ignored until a handler is set.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    jobs = pickle.loads(open(sys.argv[1], "rb").read())
    run_jobs(jobs, processes=1, on_done=lambda outcome: print(outcome.name, flush=True))
"""


def test_ctrl_c_ends_all_processes_without_partial_files(clip_job: ClipJob, tmp_path: Path) -> None:
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


def write_order(
    clip: ClipJob, count: int, pairs: list[tuple[int, int]], dubs: list[int]
) -> list[Job]:
    """Return jobs of clips named by their numbers, of pairs of them, and of clips dubbed."""
    clips = [numbered(clip, number) for number in range(count)]
    dub = DubJob(
        name="d", picture=video_of(clip), speech=clip.speech, start=0.0, end=1.0, seconds=1.0,
        video=Path("other.mp4"),
    )  # fmt: skip
    sides = [[frames_of(clips[number]) for number in pair] for pair in pairs]
    return [
        *clips,
        *(replace(pair_of(clip, "p"), left=left, right=right) for left, right in sides),
        *(replace(dub, picture=video_of(clips[number])) for number in dubs),
    ]


def sources_of(job: Job) -> tuple[Path, ...]:
    """Return the files of clips that a job is made from."""
    if isinstance(job, PairJob):
        return (job.left, job.right)
    return (job.picture,) if isinstance(job, DubJob) else ()


@given(data=st.data(), clips=st.integers(1, 6))
def test_every_job_starts_once_after_its_clips_or_fails_once_with_them(
    job: ClipJob, data: st.DataObject, clips: int
) -> None:
    numbers = st.integers(0, clips - 1)
    pairs = data.draw(st.lists(st.tuples(numbers, numbers), max_size=12))
    clip = replace(job, frames=Path("a.mkv"), video=Path("a.mp4"))
    jobs = write_order(clip, clips, pairs, data.draw(st.lists(numbers, max_size=3)))
    jobs = data.draw(st.permutations(jobs))
    order, begun, lost, running = JobOrder(jobs), [], [], []
    finished: set[Path] = set()
    while True:
        while (number := order.next()) is not None:
            assert finished.issuperset(sources_of(jobs[number]))
            running.append(number)
        if not running:
            break
        number = running.pop(data.draw(st.integers(0, len(running) - 1)))
        begun.append(number)
        if data.draw(st.booleans()):
            finished.update(jobs[number].outputs)
            order.succeeded(number)
        else:
            lost += order.failed(number)
    assert sorted(begun + lost) == list(range(len(jobs)))
