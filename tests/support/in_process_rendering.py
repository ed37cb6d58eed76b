"""Rendering in the process of the test, which starts no other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import pytest

from renderer.jobs import making
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


@contextmanager
def rendering_in_process() -> Iterator[None]:
    """Let studies be rendered without starting another process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(making, "LocalWorkers", InProcessWorker)
        for name, number in making.ONE_THREAD.items():
            patch.setenv(name, number)
        yield
