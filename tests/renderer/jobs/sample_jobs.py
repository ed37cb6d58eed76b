"""Pairs of clips, several clips each with its pair, and processes that die while working."""

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

from renderer.video_jobs import ClipJob, Job, PairJob
from tests.support.servers.processes import descendants


def video_of(job: Job) -> Path:
    """Return the path of a job's video."""
    assert job.video is not None
    return job.video


def frames_of(clip: ClipJob) -> Path:
    """Return the path of a clip's frames."""
    assert clip.frames is not None
    return clip.frames


def pair_of(clip: ClipJob, name: str) -> PairJob:
    """Return a pair of a clip with itself."""
    return PairJob(
        name=name,
        left=frames_of(clip),
        right=frames_of(clip),
        speech=clip.speech,
        start=clip.start,
        end=clip.end,
        video=video_of(clip).with_name(f"{name}.mp4"),
        look=clip.look,
    )


def clips_and_pairs(clip: ClipJob, count: int) -> list[Job]:
    """Return `count` clips, each followed by a pair of it."""
    jobs: list[Job] = []
    for number in range(count):
        one = numbered(clip, number)
        jobs += [one, pair_of(one, f"pair{number}")]
    return jobs


def numbered(clip: ClipJob, number: int) -> ClipJob:
    """Return a clip of the same motion that writes files of its own."""
    frames, video = (path.with_stem(f"clip{number}") for path in (frames_of(clip), video_of(clip)))
    return replace(clip, name=f"clip{number}", frames=frames, video=video)


def _writers_into(folder: Path) -> list[int]:
    """Return the descendants of this process that have a file open in `folder`."""
    writers = []
    for pid in descendants(os.getpid()):
        with suppress(OSError):
            files = [link.readlink() for link in Path(f"/proc/{pid}/fd").iterdir()]
            if any(file.parent == folder for file in files):
                writers.append(pid)
    return writers


@contextmanager
def killing_writers(folder: Path, times: int) -> Iterator[list[int]]:
    """Kill the process that writes into `folder`, this many times; give the killed ones."""
    over, killed = threading.Event(), list[int]()

    def kill() -> None:
        while len(killed) < times and not over.wait(0.03):
            for pid in _writers_into(folder):
                if pid not in killed:
                    os.kill(pid, signal.SIGKILL)
                    killed.append(pid)

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    try:
        yield killed
    finally:
        over.set()
        killer.join()
