"""The web application of one study."""

from __future__ import annotations

import hashlib
import math
import threading
import time
from pathlib import Path
from typing import Any, Final

from flask import Flask, Response, request
from jinja2 import StrictUndefined

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of, sqlite_url
from studyapp.researchers.interim.computing import FigureProcess
from studyapp.session.served_study import ServedStudy, VideoRecord
from studyapp.session.versions import open_study
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.form import LONGEST_TEXT
from studyapp.web import health, media
from studyapp.web.errors import register_error_pages
from studyapp.web.headers import protect
from studyapp.web.language import language_of, speak
from studyapp.web.media_store.store import MediaStore
from studyapp.web.participants import entrance, participant, sound_check
from studyapp.web.participants.trying import WithTestParticipations
from studyapp.web.research.pages import research_pages
from studyapp.web.running import Running, attach
from studyapp.web.sub_path import SubPath, checked_prefix

LETTERS = 32


def window_name(token: str) -> str:
    """Return a name that is the same for all windows of a participant and leads nowhere."""
    return hashlib.sha256(f"window {token}".encode()).hexdigest()[:LETTERS]


LARGEST_REQUEST: Final = 64 * 1024
SCRIPT_SECONDS: Final = 300
"""How long a browser may keep style and scripts without asking again."""


class StudyWeb(Flask):
    """Flask with a log that holds no address: addresses hold participants' tokens."""

    def log_exception(self, exc_info: Any) -> None:
        """Log a failure under the name of the page, with its traceback."""
        self.logger.error("Failed at %s %s", request.method, request.endpoint, exc_info=exc_info)


def create_app(
    folder: Path,
    *,
    database_url: str | None = None,
    rehearsal_speed: float | None = None,
    tried: bool = False,
    accel_prefix: str | None = None,
    prefix: str = "",
    served: ServedStudy | None = None,
    store: MediaStore | None = None,
    origin: str = "",
) -> Flask:
    """Make the application that serves the study in `folder`.

    Parameters
    ----------
    folder : Path
        The study folder; its videos must be complete.
    database_url : str, optional
        See `studyapp.database.engine.database_url_of`.
    rehearsal_speed : float, optional
        Makes a rehearsal: seconds that count as passed for each real one.
    tried : bool
        Makes the application for test participations, whose database is their own.
    accel_prefix : str, optional
        Where a proxy in front finds the study folder: videos are left to it (X-Accel-Redirect).
    prefix : str
        The path on the host below which the study lies; empty where it has the host to itself.
    served : ServedStudy, optional
        What was read of `folder` before; a process that takes another one's place then serves
        the same study, whatever has become of the files.
    store : MediaStore, optional
        Where participants load the videos from.
    origin : str
        What the study's public addresses begin with, such as ``https://study.example.org``; empty
        where nobody has said so.

    Raises
    ------
    InputError
        If the study, its media or its database cannot be used, `prefix` is not a path, or the
        study's design is not the one that its participants were asked about.
    """
    if rehearsal_speed is not None and not rehearsal_speed > 0:
        raise InputError("a rehearsal's speed must be above 0", where=f"speed {rehearsal_speed}")
    prefix = checked_prefix(prefix)
    rehearsal = rehearsal_speed is not None
    served = served or ServedStudy.read(folder)
    served = served.opened_to_try() if tried else served.opened_for(rehearsal=rehearsal)
    files = StudyFolder(folder)
    if tried:
        database_url = sqlite_url(files.tries)
    url = database_url_of(folder, database_url=database_url, rehearsal=rehearsal)
    app = StudyWeb("studyapp.web")
    app.config["MAX_CONTENT_LENGTH"] = LARGEST_REQUEST
    app.config["SEND_FILE_MAX_AGE_DEFAULT"] = SCRIPT_SECONDS
    app.jinja_env.undefined = StrictUndefined
    app.jinja_env.globals.update(window_name=window_name, longest_text=LONGEST_TEXT, tried=tried)
    app.jinja_env.trim_blocks = app.jinja_env.lstrip_blocks = True
    here = Running(
        served=served,
        database=Database.open(url),
        clock=Clock(speed=rehearsal_speed or 1.0),
        folder=folder.resolve(),
        record=VideoRecord(folder.resolve(), served),
        figures=FigureProcess(folder.resolve(), url),
        accel_prefix=accel_prefix,
        store=store,
        origin=origin,
    )
    open_study(here.database, served, here.clock, new_version=tried)
    attach(app, here)
    keep_pace(app, here.clock)
    speak(app, language_of(served.study.page.language))
    app.register_blueprint(entrance.pages)
    app.register_blueprint(participant.pages)
    app.register_blueprint(sound_check.pages)
    app.register_blueprint(media.pages)
    app.register_blueprint(health.pages)
    if not rehearsal and not tried:
        # A rehearsal is looked at from the study's own server, where researchers have accounts.
        app.register_blueprint(research_pages())
    register_error_pages(app)
    protect(
        app,
        recruitment=served.study.recruitment,
        media="" if store is None else store.origin,
    )
    if not rehearsal and not tried:
        app.wsgi_app = WithTestParticipations(  # type: ignore[method-assign]
            app.wsgi_app,
            lambda: create_app(
                folder, tried=True, served=served, accel_prefix=accel_prefix, store=store
            ),
            files.tries,
        )
    if prefix:
        app.wsgi_app = SubPath(app.wsgi_app, prefix)  # type: ignore[method-assign]
    return app


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
