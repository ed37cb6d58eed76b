"""Bringing speech, motion and videos into a study in the browser: uploading, then importing.

A script sends large files piece by piece, each with where it begins; without scripts, a form sends
small ones. Importing is a job, see `studyapp.desk.job_kinds`.
"""

from __future__ import annotations

from typing import Final

from flask import abort, jsonify, redirect, request, url_for
from flask.typing import ResponseReturnValue
from pydantic import ValidationError

from motion.errors import InputError
from motion.segment import EMOTIONS
from studyapp.desk.inbox import LARGEST_FILE, LARGEST_PIECE, Inbox, Upload, WrongOffsetError
from studyapp.desk.job_page import MOST_SHOWN
from studyapp.desk.jobs import job_log, job_standings
from studyapp.desk.lab import OpenedStudy, current_lab
from studyapp.desk.page import StudyPage, page
from studyapp.researchers.account import Right
from studyapp.study.folder import IMPORTABLE_ENDINGS

IMPORT: Final = "import"
"""The kind of job that brings files in."""

REFUSED: Final = "refused: "
"""What lines of its log begin with that say why a file was not brought in."""


def bring_in(study: OpenedStudy) -> ResponseReturnValue:
    """Show what is in the inbox, and what became of the last import."""
    return _page(study)


def uploaded(study: OpenedStudy) -> ResponseReturnValue:
    """Tell how much of a file is here."""
    try:
        return jsonify(offset=_inbox(study).received(_stated()))
    except InputError as error:
        return _refusal(error)


def take_piece(study: OpenedStudy) -> ResponseReturnValue:
    """Add a piece to a file."""
    offset = request.args.get("offset", "")
    if not (offset.isascii() and offset.isdecimal()):
        abort(400)
    try:
        lab = _inbox(study).append(_stated(), int(offset), request.get_data())
    except WrongOffsetError as error:
        return jsonify(offset=error.offset), 409
    except InputError as error:
        return _refusal(error)
    return jsonify(offset=lab)


def take_files(study: OpenedStudy) -> ResponseReturnValue:
    """Take small files from a form."""
    inbox = _inbox(study)
    now = round(current_lab().clock.now().timestamp() * 1000)
    try:
        for sent in request.files.getlist("files"):
            content = sent.read()
            file = Upload(
                condition=request.form.get("condition", "").strip(),
                name=sent.filename or "",
                size=len(content),
                changed=now,
            )
            inbox.append(file, 0, content)
    except WrongOffsetError:
        abort(409)
    except InputError as error:
        return _page(study, error), 422
    return redirect(url_for("research.bring_in", study=study.name), 303)


def remove_upload(study: OpenedStudy) -> ResponseReturnValue:
    """Remove a file from the inbox."""
    _inbox(study).remove(request.form.get("condition", ""), request.form.get("name", ""))
    return redirect(url_for("research.bring_in", study=study.name), 303)


def _inbox(study: OpenedStudy) -> Inbox:
    return Inbox(study.folder)


def _stated() -> Upload:
    """Return which file the address of a request is about."""
    try:
        return Upload.model_validate(request.args.to_dict())
    except ValidationError:
        abort(400)


def _refusal(error: InputError) -> ResponseReturnValue:
    return jsonify(problem=f"{error.what[:1].upper()}{error.what[1:]}. {error.remedy}."), 422


def _page(study: OpenedStudy, problem: InputError | None = None) -> str:
    files = _inbox(study).files()
    said = job_log(study.folder.jobs, IMPORT, most=MOST_SHOWN).splitlines()
    return page(
        "bring_in",
        study=study,
        problem=problem,
        files=files,
        has_speech=any(file.condition == "" for file in files),
        conditions=_conditions(study),
        emotions=EMOTIONS,
        endings=IMPORTABLE_ENDINGS,
        piece=LARGEST_PIECE,
        largest=LARGEST_FILE,
        last=job_standings(study.folder.jobs).get(IMPORT),
        refusals=[
            line.removeprefix(REFUSED).removeprefix(f"{study.folder.inbox.name}/")
            for line in said
            if line.startswith(REFUSED)
        ],
    )


def _conditions(study: OpenedStudy) -> list[str]:
    """Return the conditions that files may be brought for; none where the study file is wrong."""
    try:
        known = study.folder.study()
    except InputError:
        return []
    generated = known.generated()
    return [name for name in (*known.conditions, known.catch.condition) if name not in generated]


PAGES: Final = (
    StudyPage("GET", "/bring-in", bring_in, Right.STEER),
    StudyPage("POST", "/bring-in/files", take_files, Right.STEER),
    StudyPage("POST", "/bring-in/remove", remove_upload, Right.STEER),
    StudyPage("GET", "/uploads", uploaded, Right.STEER),
    StudyPage("POST", "/uploads", take_piece, Right.STEER),
)
