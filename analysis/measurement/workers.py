"""Measuring in several processes at once."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import Self, TypeVar

from threadpoolctl import threadpool_limits

Show = Callable[[int, int], None]
"""Told how many tasks are done, of how many."""

_Task = TypeVar("_Task")
_Found = TypeVar("_Found")


class Workers:
    """Does tasks in this process, or in several; results come in the order of the tasks."""

    def __init__(self, processes: int) -> None:
        self._pool = None
        if processes > 1:
            context = multiprocessing.get_context("spawn")
            self._pool = ProcessPoolExecutor(
                processes, mp_context=context, initializer=_one_thread_each
            )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def each(
        self, do: Callable[[_Task], _Found], tasks: Sequence[_Task], on_progress: Show | None
    ) -> list[_Found]:
        """Return what `do` finds out about each of `tasks`."""
        show = on_progress or (lambda done, total: None)
        if self._pool is None:
            results = []
            for number, task in enumerate(tasks, start=1):
                results.append(do(task))
                show(number, len(tasks))
            return results
        futures = [self._pool.submit(do, task) for task in tasks]
        for number, _ in enumerate(as_completed(futures), start=1):
            show(number, len(tasks))
        return [future.result() for future in futures]


def _one_thread_each() -> None:
    """Leave each process one thread for matrix products: together they have all processors."""
    threadpool_limits(1)


class Steps:
    """Counts the steps of several tasks after each other as one progress.

    Parameters
    ----------
    total : int
        Steps of all tasks together.
    show : callable or None
        Told how many steps are done, of `total`.
    """

    def __init__(self, total: int, show: Show | None) -> None:
        self._total = total
        self._show = show
        self._begun = 0

    def of(self, tasks: Sequence[object]) -> Show:
        """Return what to tell about the next `tasks`, each of which is a step."""
        before = self._begun
        self._begun += len(tasks)

        def told(done: int, _: int) -> None:
            if self._show is not None:
                self._show(before + done, self._total)

        return told
