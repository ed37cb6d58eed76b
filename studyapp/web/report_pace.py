"""How many reports of what was played one participant may send a second.

A page sends one every two seconds while a video plays, and one at its end. Each process counts for
itself, so that nothing has to be asked of the database; with several, a participant may send as
many to each.
"""

from __future__ import annotations

import math
import threading
import time
from typing import Final

from flask import Flask, Response, request

from studyapp.clock import Clock

PER_SECOND: Final = 3.0
AT_ONCE: Final = 30
"""Reports that may come together, as from a page whose line was lost for long."""

KEPT: Final = 10_000
"""Participants after which those are forgotten who have sent nothing for a while."""


class Pace:
    """Lets each participant send `AT_ONCE` reports at once, and `PER_SECOND` in the long run."""

    def __init__(self) -> None:
        self._paid_until: dict[int, float] = {}
        self._lock = threading.Lock()

    def seconds_to_wait(self, token: str, now: float) -> float:
        """Count a report; return 0, or how long to wait with it where it is one too many.

        Parameters
        ----------
        token : str
            The participant's.
        now : float
            The present moment in seconds, from any one beginning.
        """
        whose = hash(token)
        with self._lock:
            if len(self._paid_until) >= KEPT:
                self._paid_until = {
                    who: until for who, until in self._paid_until.items() if until > now
                }
            until = max(now, self._paid_until.get(whose, now)) + 1 / PER_SECOND
            wait = until - now - AT_ONCE / PER_SECOND
            if wait > 1e-9:
                return wait
            self._paid_until[whose] = until
            return 0.0


def keep_pace(app: Flask, clock: Clock) -> None:
    """Refuse reports to `app` beyond what one participant may send, before anything is read."""
    pace = Pace()

    @app.before_request
    def refuse_too_many() -> Response | None:
        if request.endpoint != "participant.watched" or request.view_args is None:
            return None
        wait = pace.seconds_to_wait(request.view_args["token"], time.monotonic() * clock.speed)
        if not wait:
            return None
        seconds = max(1, math.ceil(wait / clock.speed))
        return Response(
            f"Too many reports of what was played. Send this one again after {seconds} s.\n",
            429,
            {"Retry-After": str(seconds)},
            mimetype="text/plain",
        )
