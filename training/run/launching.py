"""The rank of a process among those that train one network together, and requests to stop.

torchrun and ``accelerate launch`` start the same command on one machine or several, and set the
environment variables ``WORLD_SIZE``, ``RANK``, ``LOCAL_RANK`` and the address where the processes
meet. A process that is asked to stop finishes the current step first.
"""

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final


def group_size() -> int:
    """Return the number of processes that the launcher started; 1 without a launcher."""
    return int(os.environ.get("WORLD_SIZE", "1")) if "LOCAL_RANK" in os.environ else 1


def is_leader() -> bool:
    """Return whether this process is the one that prints and writes; true without a launcher."""
    return group_size() == 1 or os.environ.get("RANK", "0") == "0"


_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def stop_request(*, heeded: int = 1) -> Iterator[list[int]]:
    """Collect SIGINT and SIGTERM in a list instead of interrupting the block.

    Outside the main thread, where signals cannot be caught, nothing changes.

    Parameters
    ----------
    heeded : int
        Number of requests that are collected; one more interrupts. A launcher of several processes
        may pass on a Ctrl-C that the terminal has already sent to each of them.
    """
    signals: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield signals
        return

    def note(number: int, frame: FrameType | None) -> None:
        if len(signals) >= heeded:
            raise KeyboardInterrupt
        signals.append(number)

    previous = {number: signal.signal(number, note) for number in _SIGNALS}
    try:
        yield signals
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)
