"""One run of something, measured."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Measured:
    """What one run cost.

    Attributes
    ----------
    rate : float
        Frames per second by the clock.
    milliseconds : float
        Processor time of all threads for one frame.
    peak_mb : float
        The largest memory that a process of its own took; not a number where it had none.
    """

    rate: float
    milliseconds: float
    peak_mb: float = float("nan")


def timed(frames: int, task: Callable[[], object]) -> Measured:
    """Return the cost of `task`, which makes a number of `frames`, in this process."""
    wall, busy = time.perf_counter(), time.process_time()
    task()
    wall, busy = time.perf_counter() - wall, time.process_time() - busy
    return Measured(rate=frames / wall, milliseconds=1000 * busy / frames)
