"""Protection of participants and server: headers of every response, and a limit on reports.

The headers keep a page's address, content and origin to itself.
"""

import math
import threading
import time
from collections.abc import Sequence
from typing import Final

from flask import Flask, Response, request

from studyapp.clock import Clock
from studyapp.session.ending import MTURK_FRAMES, MTURK_SITES
from studyapp.study.settings.recruitment import Recruitment

PROTECTION: Final = {
    # The address of a page holds the participant's token.
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Robots-Tag": "noindex",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


PARTICIPANTS: Final = ("entrance", "participant", "sound_check")
"""Blueprints of the pages that a recruiter may show in a frame."""


FOREIGN_FILES: Final = "research.job_file"
"""Endpoint of files that are no pages of the server, such as reports."""

SHUT_IN: Final = (
    "sandbox allow-scripts allow-downloads; default-src data: blob: 'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""The policy of such files: their scripts have no origin, and load nothing."""

REFUSAL: Final = 400
"""Responses with this status or a higher one are the server's own pages."""

BROWSERS_KEEP: Final = ("static", "media.video", "research.viewer_file", "research.viewer_avatar")
"""Endpoints of files that browsers may keep."""


def protect(app: Flask, *, recruitment: Recruitment, media: str = "") -> None:
    """Add the headers to every response of `app`.

    Participants' pages can be framed by other sites only if a recruiter needs it; researchers'
    pages never.

    Parameters
    ----------
    media : str
        The origin of the store that participants load videos from; empty where there is none.
    """
    # The viewer of motion plays speech from data addresses.
    alone = _policy(media="data:") | {"X-Frame-Options": "DENY"}
    framed = _policy(media=media) | {"X-Frame-Options": "DENY"}
    if recruitment.channel == "mturk":
        # X-Frame-Options cannot name several sites: 'frame-ancestors' does, and stands alone.
        framed = _policy(frames=MTURK_FRAMES, forms=MTURK_SITES, media=media)

    @app.after_request
    def add_headers(response: Response) -> Response:
        response.headers.update(PROTECTION)
        response.headers.update(framed if request.blueprint in PARTICIPANTS else alone)
        if request.endpoint == FOREIGN_FILES and response.status_code < REFUSAL:
            response.headers["Content-Security-Policy"] = SHUT_IN
        if request.endpoint not in BROWSERS_KEEP:
            response.headers["Cache-Control"] = "no-store"
            response.headers.pop("Expires", None)
        return response


def _policy(
    *, frames: Sequence[str] = (), forms: Sequence[str] = (), media: str = ""
) -> dict[str, str]:
    """Return the policy of pages that `frames` may show, and whose forms may go to `forms`.

    Their videos may also come from `media`.
    """
    rules = (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self'",
        f"media-src 'self' {media}".rstrip(),
        f"connect-src 'self' {media}".rstrip(),
        " ".join(("form-action 'self'", *forms)),
        "base-uri 'none'",
        " ".join(("frame-ancestors", *(frames or ("'none'",)))),
    )
    return {"Content-Security-Policy": "; ".join(rules)}


PER_SECOND: Final = 3.0


AT_ONCE: Final = 30
"""Reports that may come together, such as after a lost connection."""


KEPT: Final = 10_000
"""Participants beyond which those who have sent nothing for a while are forgotten."""


class Pace:
    """Lets each participant send `AT_ONCE` reports at once, and `PER_SECOND` in the long run."""

    def __init__(self) -> None:
        self._paid_until: dict[int, float] = {}
        self._lock = threading.Lock()

    def seconds_to_wait(self, token: str, now: float) -> float:
        """Count a report; return 0, or how long to wait if it is one too many.

        Parameters
        ----------
        token : str
            The participant's token.
        now : float
            The present moment in seconds, on any clock.
        """
        participant = hash(token)
        with self._lock:
            if len(self._paid_until) >= KEPT:
                self._paid_until = {
                    each: until for each, until in self._paid_until.items() if until > now
                }
            until = max(now, self._paid_until.get(participant, now)) + 1 / PER_SECOND
            wait = until - now - AT_ONCE / PER_SECOND
            if wait > 1e-9:
                return wait
            self._paid_until[participant] = until
            return 0.0


def keep_pace(app: Flask, clock: Clock) -> None:
    """Refuse a participant's excess reports before they are read."""
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
