"""The cost of one run."""

import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Measured:
    """The cost of one run.

    Attributes
    ----------
    rate : float
        Frames per second of wall-clock time.
    milliseconds : float
        Processor time of all threads per frame.
    peak_mb : float
        Peak memory of its process; NaN if it had no process of its own.
    """

    rate: float
    milliseconds: float
    peak_mb: float = float("nan")


def timed(frames: int, task: Callable[[], object]) -> Measured:
    """Return the cost of `task`, which makes `frames` frames in this process."""
    wall, busy = time.perf_counter(), time.process_time()
    task()
    wall, busy = time.perf_counter() - wall, time.process_time() - busy
    return Measured(rate=frames / wall, milliseconds=1000 * busy / frames)
