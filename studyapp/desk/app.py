"""The desk's web application, with each of its studies below the name of its folder."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from flask import Flask, redirect, url_for
from flask.typing import ResponseReturnValue

from studyapp.clock import Clock
from studyapp.database.engine import Database, sqlite_url
from studyapp.desk.inbox import LARGEST_PIECE
from studyapp.desk.lab import ACCOUNTS, Lab
from studyapp.desk.pages import desk_pages
from studyapp.study.settings.recruitment import Recruitment
from studyapp.web.app import LARGEST_REQUEST, StudyWeb, health_pages
from studyapp.web.protection import protect
from studyapp.web.site import attach

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
