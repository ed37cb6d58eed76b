"""Processor time of a piece of work."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

Found = TypeVar("Found")


def timed(work: Callable[[], Found], *, turns: int = 1) -> tuple[Found, float]:
    """Return what `work` returns, and its processor time in seconds.

    The least of `turns` counts: other work of a machine only ever adds. `turns` is at least 1.
    """
    least = float("inf")
    for _ in range(turns):
        began = time.process_time()
        found = work()
        least = min(least, time.process_time() - began)
    return found, least
