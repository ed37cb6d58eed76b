"""Reading and editing a study file in the browser."""

import difflib
import re
from collections.abc import Iterator
from contextlib import suppress
from typing import Final

from flask import redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError, listed
from studyapp.database.tables.researchers import Event
from studyapp.desk.lab import OpenedStudy
from studyapp.desk.page import page
from studyapp.researchers.account import Right
from studyapp.session.versions import definition_in_use
from studyapp.study.settings.reading import parse_text, read_study, read_text
from studyapp.study.study_file import ChangedMeanwhileError, replace_text, text_digest
from studyapp.study.versioning import changeable_keys, design_changes
from studyapp.web.participants.text_pages import text_pages
from studyapp.web.research.pages import Page

LINE: Final = re.compile(r"\bline (\d+)")


def settings(study: OpenedStudy) -> ResponseReturnValue:
    """Show the study file, to be edited."""
    text = read_text(study.folder.definition)
    return _page(study, text, digest=text_digest(text))


def texts(study: OpenedStudy) -> ResponseReturnValue:
    """Show the pages with the texts of the saved study file as participants see them."""
    definition = read_study(study.folder.definition)
    missing = None
    try:
        trials = definition.plan(definition.arms[0], 0, study.folder.segments_of(definition))
    except InputError as error:
        trials, missing = (), error
    return page("texts", problem=missing, study=study, pages=text_pages(definition, trials))


def save_settings(study: OpenedStudy) -> ResponseReturnValue:
    """Save the study file, unless it is wrong or somebody else has saved another one."""
    text = request.form.get("text", "").replace("\r\n", "\n").rstrip() + "\n"
    digest, is_new_version = request.form.get("seen", ""), "new_version" in request.form
    keys: tuple[str, ...] = ()
    try:
        keys = _changed_design(study, text)
        if keys and not is_new_version:
            raise InputError(
                f"people have taken part, and {listed(keys)} may not change under them",
                remedy="Undo that, or save it as a new version: earlier answers are kept apart, "
                "and unfinished participants of what has changed cannot go on",
            )
        if is_new_version and not study.account.may(Right.MANAGE):
            raise InputError("only owners begin a new version", remedy="Ask one of them")
        _save(study, text, digest)
    except ChangedMeanwhileError as error:
        digest = text_digest(error.text)
        return _page(study, text, digest=digest, problem=error, other=error.text), 409
    except InputError as error:
        return _page(study, text, digest=digest, problem=error, is_new_version=bool(keys)), 422
    if is_new_version:
        with suppress(InputError):
            # If a video is missing, the study's page says so, and offers to begin it later.
            study.study.begin_new_version(by=study.account.name)
        return redirect(url_for("research.study_page", study=study.name), 303)
    return redirect(url_for("research.settings", study=study.name, saved=""), 303)


def _save(study: OpenedStudy, text: str, digest: str) -> None:
    # The study's database makes all processes of the server wait for each other.
    with study.database.writing() as session:
        before = read_text(study.folder.definition)
        replace_text(study.folder.definition, text, seen=digest)
        if text != before:
            study.log(session, Event.DEFINITION_EDITED, "")


def _changed_design(study: OpenedStudy, text: str) -> tuple[str, ...]:
    """Return the keys of `text` that may not change under those who take part."""
    text_in_use = definition_in_use(study.database)
    where = study.folder.definition.name
    changed = parse_text(text, where=where)
    if text_in_use is None:
        return ()
    return design_changes(parse_text(text_in_use, where=where), changed)


def _page(
    study: OpenedStudy,
    text: str,
    *,
    digest: str,
    problem: InputError | None = None,
    other: str = "",
    is_new_version: bool = False,
) -> str:
    lines = text.split("\n")
    return page(
        "settings",
        study=study,
        text=text,
        digest=digest,
        problem=problem,
        lines=lines,
        findings=sorted(_findings(problem, len(lines))) if problem else [],
        difference=list(difflib.unified_diff(other.split("\n"), lines, n=1, lineterm=""))[2:]
        if other
        else [],
        is_new_version=is_new_version,
        is_taken=definition_in_use(study.database) is not None,
        changeable=changeable_keys(),
        saved="saved" in request.args,
    )


def _findings(problem: InputError, line_count: int) -> Iterator[tuple[int, str, str]]:
    """Yield the line that each message names, 0 for none, and the words before and after it."""
    for message in problem.what.split("; "):
        match = LINE.search(message)
        if match and 1 <= int(match[1]) <= line_count:
            yield int(match[1]), message[: match.start()], message[match.end() :]
        else:
            yield 0, message, ""


PAGES: Final = (
    Page("GET", "/texts", texts, Right.WATCH),
    Page("GET", "/settings", settings, Right.STEER),
    Page("POST", "/settings", save_settings, Right.STEER),
)
