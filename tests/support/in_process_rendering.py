"""Rendering in the process of the test, which starts no other."""

from __future__ import annotations

from collections.abc import Sequence

from renderer.jobs.doing import Stages, do_job
from renderer.video_jobs import Job, Outcome


class InProcessWorker:
    """Stands in for `LocalWorkers`: does one job at a time, when it is begun."""

    def __init__(self, processes: int) -> None:
        del processes
        self._stages = Stages()
        self._ended: list[tuple[int, Outcome]] = []

    def __enter__(self) -> InProcessWorker:
        return self

    def __exit__(self, *_: object) -> None:
        self._stages.__exit__()

    def room(self) -> bool:
        return not self._ended

    def begin(self, number: int, job: Job) -> None:
        self._ended.append((number, do_job(job, self._stages)))

    def ended(self) -> Sequence[tuple[int, Outcome]]:
        ended, self._ended = self._ended, []
        return ended
