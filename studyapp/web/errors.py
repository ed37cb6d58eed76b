"""Error pages: what happened, what to do, and that nothing is lost."""

from typing import Final

from flask import Flask, abort, jsonify, render_template, request, url_for
from flask.typing import ResponseReturnValue
from sqlalchemy.exc import OperationalError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from werkzeug.datastructures import MultiDict
from werkzeug.exceptions import HTTPException

from studyapp.database.sqlite import WriterLockError
from studyapp.session.refusal import (
    ConflictError,
    CrowdedAddressError,
    NotTheirsError,
    RefusalError,
    UnacceptableError,
    UninvitedError,
    UnknownAddressError,
    UnprovenError,
    log_refusal,
)
from studyapp.study.settings.presentation import Message
from studyapp.web.language import _, say
from studyapp.web.site import study_site

STATUS: Final[dict[type[RefusalError], int]] = {
    UnknownAddressError: 404,
    NotTheirsError: 403,
    UninvitedError: 403,
    UnprovenError: 403,
    CrowdedAddressError: 429,
    ConflictError: 409,
    UnacceptableError: 422,
}


def status_of(refusal: RefusalError) -> int:
    """Return the status of a refusal, or of the kind of refusals to which it belongs."""
    return next(STATUS[kind] for kind in type(refusal).__mro__ if kind in STATUS)


NOT_FOUND: Final = (
    Message("This page does not exist."),
    Message("Please open the link you were given once more; nothing you answered is lost."),
)
NOT_UNDERSTOOD: Final = (
    Message("Your browser's request could not be understood."),
    Message("Please go back and try again; what you answered before is stored."),
)
"""For every other request that is wrong itself."""

OUR_FAULT: Final = (
    Message("Something went wrong on our side."),
    Message("What you answered before is stored. Please wait a moment and try again."),
)

NUL: Final = "\0"


def wants_json() -> bool:
    """Return whether the request comes from a script rather than from a form."""
    kinds = request.accept_mimetypes
    return kinds.best_match(["text/html", "application/json"]) == "application/json"


def register_error_pages(app: Flask) -> None:
    """Show every refusal and failure of `app` as a friendly page."""

    @app.before_request
    def refuse_nul() -> None:
        """Refuse the one character that no text of PostgreSQL, and no path, can hold."""
        if NUL in request.path or _holds_nul(request.args):
            abort(404)
        if _holds_nul(request.form):
            abort(400)

    @app.errorhandler(RefusalError)
    def refuse(refusal: RefusalError) -> ResponseReturnValue:
        note_and_explain(refusal)
        return _page(refusal.messages, status_of(refusal))

    @app.errorhandler(OperationalError)
    @app.errorhandler(PoolTimeoutError)
    @app.errorhandler(WriterLockError)
    def ask_for_patience(error: SQLAlchemyError | WriterLockError) -> ResponseReturnValue:
        cause = error.orig if isinstance(error, OperationalError) else error
        first_line = (str(cause).splitlines() or [""])[0]
        app.logger.error("The database cannot be used: %s (%s)", first_line, type(cause).__name__)
        return _page(OUR_FAULT, 503)

    @app.errorhandler(HTTPException)
    def fail(error: HTTPException) -> ResponseReturnValue:
        status = error.code or 500
        if status == 404:
            return _page(NOT_FOUND, status)
        return _page(OUR_FAULT if status >= 500 else NOT_UNDERSTOOD, status)


def _holds_nul(values: MultiDict[str, str]) -> bool:
    return any(NUL in name or NUL in value for name, value in values.items(multi=True))


def note_and_explain(refusal: RefusalError) -> str:
    """Note a participant's refusal for researchers; return what happened and what to do."""
    token = (request.view_args or {}).get("token")
    page = (request.endpoint or "").rpartition(".")[2]
    # A report of what was played may cross with *Next*, which is nobody's mistake.
    is_late = page == "watched" and type(refusal) is ConflictError
    if token is not None and page and not is_late:
        site = study_site()
        log_refusal(site.database, token, page, refusal, site.clock)
    return _joined(refusal.messages)


def _joined(messages: tuple[Message, Message]) -> str:
    what, remedy = messages
    return _("%(what)s %(remedy)s", what=say(what), remedy=say(remedy))


def _page(messages: tuple[Message, Message], status: int) -> ResponseReturnValue:
    if wants_json():
        return jsonify(problem=_joined(messages)), status
    token = (request.view_args or {}).get("token")
    has_way_back = token is not None and status != 404
    what, remedy = messages
    return render_template(
        "problem.html",
        study=study_site().study,
        what=say(what),
        remedy=say(remedy),
        back=url_for("participant.stand", token=token) if has_way_back else None,
    ), status
