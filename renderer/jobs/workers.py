"""Where jobs are done: the one interface of processes here and of a cluster."""

from __future__ import annotations

from collections.abc import Sequence
from types import TracebackType
from typing import Protocol, Self

from renderer.jobs.job import Job, Outcome


class Workers(Protocol):
    """Processes that do jobs, each with one OpenGL context; a ``with`` block begins and ends it."""

    def __enter__(self) -> Self:
        """Get ready; `InputError` where that is impossible."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Begin nothing more, and leave no half-written video."""

    def room(self) -> bool:
        """Tell whether one more job would be taken up at once."""

    def begin(self, number: int, job: Job) -> None:
        """Have `job` done; `number` tells it apart."""

    def ended(self) -> Sequence[tuple[int, Outcome]]:
        """Wait until at least one begun job has ended, and return those that have.

        A job whose process died is done again by another process, and given up only when it
        ends that one too.
        """
