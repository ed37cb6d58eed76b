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
        self.made = False

    def __bool__(self) -> bool:
        """Tell whether the request was made."""
        return self.made


@contextmanager
def stop_request() -> Iterator[StopRequest]:
    """Note Ctrl-C, and a batch system's request to end, rather than break off at once.

    A second Ctrl-C breaks off. Outside the main thread, where signals cannot be caught, nothing
    changes.
    """
    request = StopRequest()
    if threading.current_thread() is not threading.main_thread():
        yield request
        return

    def note(number: int, frame: FrameType | None) -> None:
        if request.made:
            raise KeyboardInterrupt
        request.made = True

    before = {number: signal.signal(number, note) for number in _SIGNALS}
    try:
        yield request
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
