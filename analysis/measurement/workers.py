"""Measuring in several processes at once."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from typing import Self, TypeVar

from threadpoolctl import threadpool_limits

Show = Callable[[int, int], None]
"""Told how many tasks are done, of how many."""

_Task = TypeVar("_Task")
_Found = TypeVar("_Found")


class Workers:
    """Does tasks in this process, or in several; results come in the order of the tasks.

    Parameters
    ----------
    processes : int
        How many.
    steps : int
        All tasks that will be given.
    on_progress : callable, optional
        Told how many of them are done.
    """

    def __init__(self, processes: int, steps: int, on_progress: Show | None) -> None:
        self._pool = None
        if processes > 1:
            context = multiprocessing.get_context("spawn")
            self._pool = ProcessPoolExecutor(
                processes, mp_context=context, initializer=_one_thread_each
            )
        self._done, self._steps = 0, steps
        self._on_progress = on_progress

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def each(self, do: Callable[[_Task], _Found], tasks: Iterable[_Task]) -> list[_Found]:
        """Return what `do` finds out about each of `tasks`."""
        results = []
        for found in map(do, tasks) if self._pool is None else self._pool.map(do, tasks):
            results.append(found)
            self._done += 1
            if self._on_progress is not None:
                self._on_progress(self._done, self._steps)
        return results


def _one_thread_each() -> None:
    """Leave each process one thread for matrix products: together they have all processors."""
    threadpool_limits(1)
