"""A pool of processes for parallel computation."""

import multiprocessing
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


class ProcessPool(ProcessPoolExecutor):
    """New processes, each with one thread for matrix products; leaving it cancels waiting tasks.

    Ctrl-C reaches all processes of a terminal. It interrupts running tasks. Processes that wait or
    are still loading modules leave it to their parent and print nothing.
    """

    def __init__(self, count: int) -> None:
        # Not forks: OpenMP's threads do not survive a fork.
        super().__init__(count, multiprocessing.get_context("spawn"), threadpool_limits, (1,))

    def submit(
        self,
        fn: Callable[_Arguments, _Result],
        /,
        *args: _Arguments.args,
        **kwargs: _Arguments.kwargs,
    ) -> Future[_Result]:
        """Submit a task; the first one starts the processes, which inherit the signal mask."""
        with _interruptions(signal.SIG_BLOCK):
            return super().submit(_run, partial(fn, *args, **kwargs))

    def __exit__(self, *_: object) -> None:
        self.shutdown(cancel_futures=True)


def _run(task: Callable[[], _Result]) -> _Result:
    try:
        with _interruptions(signal.SIG_UNBLOCK):
            return task()
    except KeyboardInterrupt:
        # It stays pending, and ends the tasks that the process has already fetched.
        signal.raise_signal(signal.SIGINT)
        raise


@contextmanager
def _interruptions(how: signal.Sigmasks) -> Iterator[None]:
    previous = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    try:
        # A pending signal is raised here.
        signal.pthread_sigmask(how, {signal.SIGINT})
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, previous)
