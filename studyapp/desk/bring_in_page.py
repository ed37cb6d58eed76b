"""Bringing speech, motion and videos into a study in the browser: uploading, then importing.

A script sends files piece by piece, each with where it begins. Importing is a job, see
`studyapp.desk.job_kinds`.
"""

from __future__ import annotations

from typing import Final

from flask import abort, jsonify, redirect, request, url_for
from flask.typing import ResponseReturnValue
from pydantic import ValidationError

from motion.errors import InputError
from motion.segment import EMOTIONS, SEGMENTS_FILE
from studyapp.desk.inbox import LARGEST_FILE, LARGEST_PIECE, Inbox, Upload, WrongOffsetError
from studyapp.desk.job_page import MOST_SHOWN
from studyapp.desk.jobs import job_log, job_standings
from studyapp.desk.lab import OpenedStudy
from studyapp.desk.page import page
from studyapp.researchers.account import Right
from studyapp.study.folder import IMPORTABLE_ENDINGS
from studyapp.web.research.pages import Page

IMPORT: Final = "import"
"""The kind of job that brings files in."""

REFUSED: Final = "refused: "
"""Begins the lines of its log that say why a file was not brought in."""


def bring_in(study: OpenedStudy) -> ResponseReturnValue:
    """Show the inbox, and how the last import went."""
    files = Inbox(study.folder).files()
    log = job_log(study.folder.jobs, IMPORT, most=MOST_SHOWN)
    # Files may have been removed since.
    waiting = tuple(f"{REFUSED}{study.folder.inbox.name}/{file.path}" for file in files)
    return page(
        "bring_in",
        study=study,
        files=files,
        # A table of segments says all of it.
        asks_about_speech=any(file.condition == "" for file in files)
        and not any(file.name == SEGMENTS_FILE for file in files),
        conditions=_conditions(study),
        emotions=EMOTIONS,
        endings=IMPORTABLE_ENDINGS,
        piece=LARGEST_PIECE,
        largest=LARGEST_FILE,
        last=job_standings(study.folder.jobs).get(IMPORT),
        refusals=[
            line.removeprefix(f"{REFUSED}{study.folder.inbox.name}/")
            for line in log.splitlines()
            if line.startswith(waiting)
        ],
    )


def uploaded(study: OpenedStudy) -> ResponseReturnValue:
    """Tell how many bytes of a file have arrived."""
    try:
        return jsonify(offset=Inbox(study.folder).received(_requested_upload()))
    except InputError as error:
        return _refusal(error)


def take_piece(study: OpenedStudy) -> ResponseReturnValue:
    """Add a piece to a file."""
    offset = request.args.get("offset", "")
    if not (offset.isascii() and offset.isdecimal()):
        abort(400)
    try:
        received = Inbox(study.folder).append(_requested_upload(), int(offset), request.get_data())
    except WrongOffsetError as error:
        return jsonify(offset=error.offset), 409
    except InputError as error:
        return _refusal(error)
    return jsonify(offset=received)


def remove_upload(study: OpenedStudy) -> ResponseReturnValue:
    """Remove a file from the inbox."""
    Inbox(study.folder).remove(request.form.get("condition", ""), request.form.get("name", ""))
    return redirect(url_for("research.bring_in", study=study.name), 303)


def _requested_upload() -> Upload:
    """Return the file that the address of a request is about."""
    try:
        return Upload.model_validate(request.args.to_dict())
    except ValidationError:
        abort(400)


def _refusal(error: InputError) -> ResponseReturnValue:
    return jsonify(problem=f"{error.what[:1].upper()}{error.what[1:]}. {error.remedy}."), 422


def _conditions(study: OpenedStudy) -> list[str]:
    """Return the conditions that take files; none where the study file is wrong."""
    try:
        definition = study.folder.study()
    except InputError:
        return []
    conditions = (*definition.conditions, definition.catch.condition)
    return [name for name in conditions if name not in definition.generated()]


PAGES: Final = (
    Page("GET", "/bring-in", bring_in, Right.STEER),
    Page("POST", "/bring-in/remove", remove_upload, Right.STEER),
    Page("GET", "/uploads", uploaded, Right.STEER),
    Page("POST", "/uploads", take_piece, Right.STEER),
)
