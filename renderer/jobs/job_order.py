"""Which job may be begun next: in the order given, but none before what it is made from."""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Sequence

from renderer.jobs.job import Job


class JobOrder:
    """The jobs of one run, by their number in the order they were given.

    A pair whose clip is among the jobs waits for it, and so does a clip that gets another speech;
    what was there before is not waited for.
    """

    def __init__(self, jobs: Sequence[Job]) -> None:
        made_by = {path: number for number, job in enumerate(jobs) for path in job.makes}
        self._awaited: dict[int, set[int]] = {}
        self._waiting_for: defaultdict[int, list[int]] = defaultdict(list)
        self._ready: list[int] = []
        for number, job in enumerate(jobs):
            awaited = {made_by[path] for path in job.needs if path in made_by}
            self._awaited[number] = awaited
            for clip in awaited:
                self._waiting_for[clip].append(number)
            if not awaited:
                self._ready.append(number)

    def next(self) -> int | None:
        """Return the first job that may be begun, and count it as begun; None if there is none."""
        return heapq.heappop(self._ready) if self._ready else None

    def succeeded(self, number: int) -> None:
        """Let the jobs that waited for this one alone be begun."""
        for pair in self._waiting_for.pop(number, []):
            self._awaited[pair].discard(number)
            if not self._awaited[pair]:
                heapq.heappush(self._ready, pair)

    def failed(self, number: int) -> list[int]:
        """Return the jobs that can no longer be done; they will not be begun."""
        lost = self._waiting_for.pop(number, [])
        for pair in lost:
            for clip in self._awaited.pop(pair):
                if clip != number:
                    self._waiting_for[clip].remove(pair)
        return lost
