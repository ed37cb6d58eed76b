"""The desk's web application, each study below the name of its folder, and its server."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from flask import Flask, redirect, url_for
from flask.typing import ResponseReturnValue
from sqlalchemy.exc import SQLAlchemyError
from werkzeug.exceptions import HTTPException

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database, sqlite_url
from studyapp.desk.inbox import LARGEST_PIECE
from studyapp.desk.lab import ACCOUNTS, Lab
from studyapp.desk.pages import desk_pages
from studyapp.monitoring.alarms import LOG, AlarmChannels, raise_alarms, watch_for_alarms
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.recruitment import Recruitment
from studyapp.web.app import LARGEST_REQUEST, StudyWeb, health_pages
from studyapp.web.protection import protect
from studyapp.web.research.pages import fail
from studyapp.web.server import WORKERS, listen, serve_application
from studyapp.web.site import attach
from studyapp.web.worker import StudyWorker

if TYPE_CHECKING:
    from _typeshed.wsgi import StartResponse, WSGIApplication, WSGIEnvironment


def open_desk(folder: Path, *, origin: str = "") -> Lab:
    """Return the desk of the studies in `folder`, with its database."""
    database = Database.open(sqlite_url(folder / ACCOUNTS))
    return Lab(folder=folder.resolve(), database=database, clock=Clock(), origin=origin)


def create_desk(lab: Lab) -> Flask:
    """Make the application of a desk and of its studies."""
    app = StudyWeb(largest_request=LARGEST_PIECE + LARGEST_REQUEST)
    app.config["MAX_FORM_MEMORY_SIZE"] = LARGEST_PIECE
    attach(app, lab)
    app.register_blueprint(desk_pages())
    app.register_blueprint(health_pages)
    app.add_url_rule("/", "root", _go_to_desk)
    app.register_error_handler(HTTPException, fail)
    protect(app, recruitment=Recruitment())
    app.wsgi_app = _with_studies(app.wsgi_app, lab)  # type: ignore[assignment, method-assign]
    return app


def _go_to_desk() -> ResponseReturnValue:
    return redirect(url_for("research.overview"), 303)


def _with_studies(desk: WSGIApplication, lab: Lab) -> WSGIApplication:
    """Return the desk with each study that can be served below its name."""

    def dispatch(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        _, _, path = environ.get("PATH_INFO", "").partition("/")
        study = lab.study(path.partition("/")[0])
        app = None if study is None else study.application()
        return (desk if app is None else app)(environ, start_response)

    return dispatch


class DeskWorker(StudyWorker):
    """A study's worker that takes larger pieces of files."""

    largest_request: ClassVar[int] = LARGEST_PIECE + LARGEST_REQUEST


def run_desk(
    folder: Path,
    host: str,
    port: int,
    workers: int = WORKERS,
    *,
    origin: str = "",
    on_ready: Callable[[], None] | None = None,
) -> None:
    """Serve the studies in `folder` until the process is told to stop (SIGINT or SIGTERM).

    Parameters
    ----------
    folder : Path
        Holds the studies as sub-folders.
    origin : str
        What public addresses begin with; empty if unknown.
    host, port, workers, on_ready
        See `studyapp.web.server.run_server`.

    Raises
    ------
    InputError
        Before anything is served: if `folder` is itself a study, the desk's database cannot be
        used, or the address is taken.
    """
    if os.environ.get("DATABASE_URL"):
        raise InputError(
            "a desk keeps the answers of each study in the study's own folder",
            where="the environment variable DATABASE_URL",
            remedy="Unset it; a study in PostgreSQL is served alone, with 'motionjury serve'",
        )
    if StudyFolder(folder).definition.exists():
        raise InputError(
            "this is a study, not a folder of studies",
            where=folder,
            remedy="Name the folder that holds it, or serve it alone, with 'motionjury serve'",
        )

    def make() -> Flask:
        lab = open_desk(folder, origin=origin)
        watch_for_alarms(partial(raise_alarms_of_studies, lab))
        return create_desk(lab)

    with listen(host, port) as listener:
        # The workers find the newest schema and need not make it all at once.
        open_desk(folder).database.close()
        serve_application(make, listener, workers, worker=DeskWorker, on_ready=on_ready)


def raise_alarms_of_studies(lab: Lab) -> None:
    """Send the alarms that are due in each study; one that cannot be read stops no other."""
    for study in lab.studies():
        try:
            served = study.served()
            if served is not None and (channels := AlarmChannels.of(served.study)).ways:
                raise_alarms(study.database, served, lab.clock, channels.send)
        except (InputError, SQLAlchemyError) as error:
            LOG.error("Alarms of %s: %s", study.name, type(error).__name__)
