"""Being asked to stop while weights change: the step under way is finished first."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final

_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)


class StopRequest:
    """Whether somebody asked to stop."""

    def __init__(self) -> None:
        self.times = 0

    def __bool__(self) -> bool:
        """Tell whether the request was made."""
        return self.times > 0


@contextmanager
def stop_request(*, heeded: int = 1) -> Iterator[StopRequest]:
    """Note Ctrl-C, and a batch system's request to end, rather than break off at once.

    Outside the main thread, where signals cannot be caught, nothing changes.

    Parameters
    ----------
    heeded : int
        How many requests are noted; one more breaks off. A launcher of several processes may hand
        on a Ctrl-C that the terminal had sent to each of them already.
    """
    request = StopRequest()
    if threading.current_thread() is not threading.main_thread():
        yield request
        return

    def note(number: int, frame: FrameType | None) -> None:
        if request.times >= heeded:
            raise KeyboardInterrupt
        request.times += 1

    before = {number: signal.signal(number, note) for number in _SIGNALS}
    try:
        yield request
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
