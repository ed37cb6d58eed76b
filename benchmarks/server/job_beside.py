"""Participants' waiting times while a job of the desk renders.

``python -m benchmarks.server.job_beside`` serves one study and renders another as the desk does.
The job is stopped and runs in turns of equal length. The ratio compares the p99 of the
participants' requests, turn by turn.
"""

import asyncio
import os
import signal
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks.rendering.sample_motion import gesturing_clip
from benchmarks.server.databases import Backend, fresh_database
from benchmarks.server.fabricated_study import StudyShape, write_fabricated_study
from benchmarks.server.load import arrive, judge
from benchmarks.server.turns import Waits, read_options
from benchmarks.server.visitor import Ledger
from motion.audio import SPEECH_RATE, Audio, write_wav
from motion.formats import write_clip
from motion.segment import Segment, write_segments
from studyapp.desk.jobs import job_log, job_standings
from studyapp.study.folder import StudyFolder
from tests.studyapp.desk.job_watching import begin, wait_until_under_way
from tests.support.servers.processes import children, descendants
from tests.support.servers.study_server import study_server
from tests.support.studies.tiny_study import EMOTIONS, STUDY_FILE

CONCURRENCIES: Final = (1, 8, 32, 128)
PAIRS: Final = 12
"""Turns without the job, each followed by one with it."""

KIND: Final = "render"
CLIP_SECONDS: Final = 120.0
FRAME_RATE: Final = 30.0


def job_waits(backend: Backend, seconds: float) -> Iterator[tuple[int, Waits]]:
    """Yield numbers of concurrent participants, each with their waiting times.

    Parameters
    ----------
    backend : Backend
        Database of the served study.
    seconds : float
        Length of each turn.
    """
    with tempfile.TemporaryDirectory(prefix="bench-") as name:
        served, rendered = Path(name, "served"), Path(name, "rendered")
        served.mkdir()
        write_fabricated_study(served, StudyShape(places=5000))
        write_unrendered_study(rendered)
        with (
            fresh_database(backend, served) as database,
            study_server(served, served / "output", database_url=database.url) as server,
            rendering(rendered / "jobs") as processes,
        ):
            for count in CONCURRENCIES:
                yield count, _waits(server.port, count, seconds, processes)


def _waits(port: int, count: int, seconds: float, processes: Sequence[int]) -> Waits:
    waits = Waits()
    _send(processes, signal.SIGSTOP)
    for turn in range(2 * PAIRS):
        ledger = Ledger()
        if turn % 2:
            _send(processes, signal.SIGCONT)
        asyncio.run(_take_part(port, count, seconds, ledger))
        _send(processes, signal.SIGSTOP)
        taken = [second for kind in ledger.seconds.values() for second in kind]
        (waits.beside if turn % 2 else waits.without).append(taken)
        waits.errors += ledger.errors
    return waits


async def _take_part(port: int, count: int, seconds: float, ledger: Ledger) -> None:
    arrived = await arrive(port, count=count, seed=count, ledger=Ledger())
    await judge(arrived, ledger=ledger, seconds=seconds)


def write_unrendered_study(folder: Path) -> None:
    """Write a study with motion but without videos."""
    study = StudyFolder(folder)
    speech = folder / "speech"
    speech.mkdir(parents=True)
    (folder / "study.toml").write_text(STUDY_FILE, encoding="utf-8")
    silence = np.zeros(round(CLIP_SECONDS * SPEECH_RATE), np.float32)
    write_wav(speech / "take.wav", Audio(silence, SPEECH_RATE))
    segments = [
        Segment(
            name=emotion,
            wav="take.wav",
            start=0,
            end=CLIP_SECONDS,
            speaker="robin",
            emotion=emotion,
        )
        for emotion in EMOTIONS
    ]
    write_segments(speech, segments)
    clip = gesturing_clip(CLIP_SECONDS, FRAME_RATE)
    for condition in ("rule_based", "mismatched", "broken"):
        for segment in segments:
            path = study.clip(condition, segment.name)
            path.parent.mkdir(parents=True, exist_ok=True)
            write_clip(path, clip)


@contextmanager
def rendering(jobs: Path) -> Iterator[Sequence[int]]:
    """Render a study as the desk does, and yield the processes that do it."""
    before = children(os.getpid())
    begin(jobs, KIND, kind=KIND)
    (job,) = set(children(os.getpid())).difference(before)
    wait_until_under_way(jobs, KIND)
    processes = (job, *descendants(job))
    try:
        yield processes
        if not job_standings(jobs)[KIND].is_running:
            raise RuntimeError("the job ended too early: " + job_log(jobs, KIND, most=2000))
    finally:
        _send(processes, signal.SIGKILL)


def _send(processes: Sequence[int], number: signal.Signals) -> None:
    for process in processes:
        with suppress(ProcessLookupError):
            os.kill(process, number)


def main() -> None:
    """Measure on both databases, and print the waits without and with the job."""
    options = read_options("Measure what a rendering job costs participants.", seconds=3.0)
    for backend in options.database:
        for count, waits in job_waits(backend, options.seconds):
            waits.print(f"{backend}_{count}", "job", total="job")


if __name__ == "__main__":
    main()
