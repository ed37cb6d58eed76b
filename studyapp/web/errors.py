"""Pages for what goes wrong: what happened, what to do, and that nothing is lost."""

from __future__ import annotations

from typing import Final

from flask import Flask, jsonify, render_template, request, url_for
from flask.typing import ResponseReturnValue
from werkzeug.exceptions import HTTPException

from studyapp.services.refusal import (
    ConflictError,
    IneligibleError,
    NotTheirsError,
    RefusalError,
    StudyFullError,
    UnacceptableError,
    UnknownAddressError,
)
from studyapp.web.running import running

STATUS: Final[dict[type[RefusalError], int]] = {
    UnknownAddressError: 404,
    NotTheirsError: 403,
    IneligibleError: 403,
    StudyFullError: 409,
    ConflictError: 409,
    UnacceptableError: 422,
}

WORDS: Final = {
    404: (
        "This page does not exist.",
        "Please open the link you were given once more; nothing you answered is lost.",
    ),
    405: ("This page cannot be opened like this.", "Please go back to the page before."),
    413: ("That was too much to send at once.", "Please go back and try again."),
}
OTHER_WORDS: Final = (
    "Something went wrong on our side.",
    "What you answered before is stored. Please wait a moment and try again.",
)


def wants_json() -> bool:
    """Tell whether the request comes from a script rather than from a form."""
    kinds = request.accept_mimetypes
    return kinds.best_match(["text/html", "application/json"]) == "application/json"


def register_error_pages(app: Flask) -> None:
    """Show every refusal and failure of `app` as a friendly page."""

    @app.errorhandler(RefusalError)
    def refuse(refusal: RefusalError) -> ResponseReturnValue:
        return _page(refusal.what, refusal.remedy, STATUS[type(refusal)])

    @app.errorhandler(HTTPException)
    def fail(error: HTTPException) -> ResponseReturnValue:
        status = error.code or 500
        return _page(*WORDS.get(status, OTHER_WORDS), status)


def _page(what: str, remedy: str, status: int) -> ResponseReturnValue:
    if wants_json():
        return jsonify(problem=f"{what} {remedy}"), status
    token = (request.view_args or {}).get("token")
    known = token is not None and status != 404
    return render_template(
        "problem.html",
        study=running().study,
        what=what,
        remedy=remedy,
        back=url_for("participant.stand", token=token) if known else None,
    ), status
