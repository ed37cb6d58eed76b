"""The web application of one study, and its health check."""

from __future__ import annotations

import hashlib
import logging
import threading
import time
from concurrent.futures import Future
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

from flask import Blueprint, Flask, Response, current_app, request
from jinja2 import StrictUndefined
from sqlalchemy.exc import SQLAlchemyError

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of, sqlite_url
from studyapp.researchers.interim_figures import FigureProcess
from studyapp.session.served_study import ServedStudy, VideoRecord
from studyapp.session.versions import open_study
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.questions import MAX_TEXT_LENGTH
from studyapp.web import media
from studyapp.web.errors import register_error_pages
from studyapp.web.language import language_of, speak
from studyapp.web.media_store import MediaStore
from studyapp.web.mounting import HEALTH, at_sub_path, checked_prefix, with_test_participations
from studyapp.web.participants import entrance, participant, sound_check
from studyapp.web.protection import keep_pace, protect
from studyapp.web.research.pages import research_pages
from studyapp.web.site import Desk, StudySite, attach, current_site

if TYPE_CHECKING:
    from _typeshed.wsgi import WSGIApplication


def window_name(token: str) -> str:
    """Return a name that all windows of a participant share, and that is no address."""
    return hashlib.sha256(f"window {token}".encode()).hexdigest()[:32]


LARGEST_REQUEST: Final = 64 * 1024
SCRIPT_SECONDS: Final = 300
"""How long browsers may keep style and scripts."""


class StudyWeb(Flask):
    """Flask whose log holds no addresses, because they hold participants' tokens."""

    def __init__(self, *, largest_request: int = LARGEST_REQUEST) -> None:
        super().__init__("studyapp.web")
        self.config["MAX_CONTENT_LENGTH"] = largest_request
        self.config["SEND_FILE_MAX_AGE_DEFAULT"] = SCRIPT_SECONDS
        self.jinja_env.undefined = StrictUndefined
        self.jinja_env.trim_blocks = self.jinja_env.lstrip_blocks = True
        self.jinja_env.globals.update(
            window_name=window_name, longest_text=MAX_TEXT_LENGTH, is_test=False
        )

    def log_exception(self, exc_info: Any) -> None:
        """Log a failure under the name of the page, with its traceback."""
        self.logger.error("Failed at %s %s", request.method, request.endpoint, exc_info=exc_info)


def create_app(
    folder: Path,
    *,
    database_url: str | None = None,
    rehearsal_speed: float | None = None,
    is_test: bool = False,
    accel_prefix: str | None = None,
    prefix: str = "",
    served: ServedStudy | None = None,
    store: MediaStore | None = None,
    origin: str = "",
    desk: Desk | None = None,
) -> Flask:
    """Make the application that serves the study in `folder`.

    Parameters
    ----------
    folder : Path
        The study folder; its videos must be complete.
    database_url : str, optional
        Of the database for answers, in place of the folder's (`database_url_of`).
    rehearsal_speed : float, optional
        Makes a rehearsal, in which so many seconds pass for each real one.
    is_test : bool
        Makes the application for test participations, which have a database of their own.
    accel_prefix : str, optional
        Where a proxy in front finds the study folder, to send the videos (X-Accel-Redirect).
    prefix : str
        The path on the host below which the study is served; empty for the whole host.
    served : ServedStudy, optional
        What was read of `folder` before, so that a restarted worker serves the same study
        whatever has become of the files.
    store : MediaStore, optional
        Where participants load the videos from.
    origin : str
        What the study's public addresses begin with, such as ``https://study.example.org``; empty
        if unknown.
    desk : Desk, optional
        The desk at which researchers log in, in place of the study's own login.

    Raises
    ------
    InputError
        If the study, its media or its database cannot be used, `prefix` is not a path, or the
        study's design has changed since participants came.
    """
    prefix = checked_prefix(prefix)
    rehearsal = rehearsal_speed is not None
    served = served or ServedStudy.read(folder)
    served = served.opened_to_try() if is_test else served.opened_for(rehearsal=rehearsal)
    files = StudyFolder(folder)
    if is_test:
        database_url = sqlite_url(files.tries)
    url = database_url or database_url_of(folder, rehearsal=rehearsal)
    app = StudyWeb()
    app.jinja_env.globals["is_test"] = is_test
    site = StudySite(
        served=served,
        database=Database.open(url),
        clock=Clock(speed=rehearsal_speed or 1.0),
        folder=folder.resolve(),
        record=VideoRecord(folder.resolve(), served),
        figures=FigureProcess(folder.resolve(), url),
        accel_prefix=accel_prefix,
        store=store,
        origin=origin,
        desk=desk,
    )
    open_study(site.database, served, site.clock, new_version=is_test)
    attach(app, site)
    keep_pace(app, site.clock)
    speak(app, language_of(served.study.page.language))
    app.register_blueprint(entrance.pages)
    app.register_blueprint(participant.pages)
    app.register_blueprint(sound_check.pages)
    app.register_blueprint(media.pages)
    app.register_blueprint(health_pages)
    if not rehearsal and not is_test:
        # Researchers watch a rehearsal at the study's own server, where they have accounts.
        app.register_blueprint(research_pages())
    register_error_pages(app)
    protect(
        app,
        recruitment=served.study.recruitment,
        media="" if store is None else store.origin,
    )
    mounted: WSGIApplication = app.wsgi_app
    if not rehearsal and not is_test:
        mounted = with_test_participations(
            mounted,
            lambda: create_app(
                folder, is_test=True, served=served, accel_prefix=accel_prefix, store=store
            ),
            files.tries,
        )
    app.wsgi_app = at_sub_path(mounted, prefix) if prefix else mounted  # type: ignore[assignment, method-assign]
    return app


KNOWN_SECONDS: Final = 1.0
"""For how long a result counts: anybody may ask, and each check costs a write."""

ANSWER_SECONDS: Final = 5.0
"""How long the database may take; one that is frozen or out of connections takes longer."""

health_pages = Blueprint("health", __name__)


@health_pages.get(HEALTH)
def health() -> Response:
    """Say whether answers can be stored, and nothing of the study."""
    check = cast(Health, current_app.extensions.setdefault(HEALTH, Health()))
    if not check.is_well(current_site().database, current_app.logger):
        return Response("Answers cannot be stored.\n", 503, mimetype="text/plain")
    return Response("ok\n", mimetype="text/plain")


class Health:
    """Whether answers can be stored, by one attempt after the other."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._attempt: Future[bool] | None = None
        self._began = 0.0

    def is_well(self, database: Database, log: logging.Logger) -> bool:
        """Return the result of the last attempt, or a new one; False if it takes too long."""
        with self._lock:
            now = time.monotonic()
            is_current = now - self._began < KNOWN_SECONDS
            if self._attempt is None or (self._attempt.done() and not is_current):
                self._attempt, self._began = Future(), now
                arguments = (self._attempt, database, log)
                threading.Thread(target=_try_writing, args=arguments, daemon=True).start()
            attempt, deadline = self._attempt, self._began + ANSWER_SECONDS
        try:
            return attempt.result(max(0.0, deadline - time.monotonic()))
        except TimeoutError:
            return False


def _try_writing(attempt: Future[bool], database: Database, log: logging.Logger) -> None:
    succeeded = False
    try:
        database.check_writable()
        succeeded = True
    except (SQLAlchemyError, InputError, OSError) as error:
        cause = getattr(error, "orig", None) or error
        log.error("Not well: %s", (str(cause).splitlines() or [""])[0])
    finally:
        attempt.set_result(succeeded)
