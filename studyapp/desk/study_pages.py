"""The desk's first page, which lists the studies, each study's page, and the ways into a study."""

from __future__ import annotations

from functools import partial
from typing import Final, cast

from flask import Response, abort, current_app, redirect, request
from flask.typing import ResponseReturnValue
from sqlalchemy.exc import SQLAlchemyError

from motion.errors import InputError
from studyapp.desk import job_page, material_page
from studyapp.desk.job_kinds import RUN, TAKE_HOME
from studyapp.desk.lab import OpenedStudy, current_lab, study_token
from studyapp.desk.membership import enter_study
from studyapp.desk.page import page
from studyapp.recruitment.invitations import make_test_participation
from studyapp.researchers.account import Right, has_owner
from studyapp.session.served_study import ServedStudy
from studyapp.study.settings.reading import read_study
from studyapp.web.mounting import path_to_try
from studyapp.web.research.page import COOKIE, researcher, visitor_cookie
from studyapp.web.research.pages import Page


def overview() -> ResponseReturnValue:
    """List the researcher's studies; to owners also those that nobody owns or that are damaged."""
    lab, is_owner = current_lab(), researcher().may(Right.MANAGE)
    rows, unowned, damaged = [], [], []
    for study in lab.studies():
        try:
            opened_study = lab.opened_study(study.name, researcher())
            if opened_study is not None:
                rows.append((opened_study, _title(opened_study), study.standing()))
            elif is_owner and not has_owner(study.database):
                unowned.append(study.name)
        except (InputError, SQLAlchemyError) as error:
            current_app.logger.error("%s cannot be listed: %s", study.name, error)
            damaged.append(study.name)
    return page("overview", rows=rows, unowned=unowned, damaged=damaged if is_owner else ())


def _title(study: OpenedStudy) -> str:
    """Return the study's title; its folder's name where the study file cannot be read."""
    try:
        return read_study(study.folder.definition).title
    except InputError:
        return study.name


def study_page(study: OpenedStudy) -> ResponseReturnValue:
    """Show how far a study is, and what can be done with it."""
    served = study.study.served()
    address = f"{current_lab().origin}/{study.name}/"
    return page(
        "study",
        study=study,
        title=_title(study),
        standing=study.study.standing(),
        link="" if served is None else served.study.recruitment.link(address),
        sections=[
            (template, title, context(study))
            for template, title, needs, context in (
                ("material", "Material", Right.WATCH, material_page.summary),
                ("jobs", "Run", Right.WATCH, partial(job_page.section, kinds=RUN)),
                (
                    "take_home",
                    "Take home",
                    Right.UNBLIND,
                    partial(job_page.section, kinds=TAKE_HOME),
                ),
            )
            if study.account.may(needs)
        ],
    )


WAYS: Final = ("", "preview", "study-sessions", "newcomers", "results", "researchers", "changes")
"""Pages of the study itself that its page at the desk leads to."""


def open_study_pages(study: OpenedStudy) -> ResponseReturnValue:
    """Go on to the study's own pages, logged in there."""
    way, token = request.form.get("way", ""), visitor_cookie()
    served = _require_served(study)
    if token is None:
        abort(403)
    enter_study(study, token)
    page_address = f"/{study.name}/research/{way if way in WAYS else ''}"
    response = cast(Response, redirect(page_address, 303))
    study_login = study_token(token, study.name)
    COOKIE.send(response, served.study.name, study_login, below=f"/{study.name}")
    return response


def take_part_as_test(study: OpenedStudy) -> ResponseReturnValue:
    """Let the researcher take part in the study; nothing of it counts."""
    invitation = make_test_participation(
        study.folder.root, _require_served(study), current_lab().clock, by=study.account.name
    )
    return redirect(f"/{study.name}{path_to_try(invitation)}", 303)


def begin_new_version(study: OpenedStudy) -> ResponseReturnValue:
    """Serve what the study file says as a new version."""
    study.study.begin_new_version()
    return redirect(request.path.removesuffix("new-version"), 303)


def _require_served(study: OpenedStudy) -> ServedStudy:
    served = study.study.served()
    if served is None:
        raise InputError(
            "the study cannot be opened yet",
            remedy="Its page at the desk says what is missing",
        )
    return served


LIST_PAGES: Final = (Page("GET", "/", overview, Right.KEEP_ACCOUNT),)

PAGES: Final = (
    Page("GET", "/", study_page, Right.KEEP_ACCOUNT),
    Page("POST", "/open", open_study_pages, Right.WATCH),
    Page("POST", "/try", take_part_as_test, Right.WATCH),
    Page("POST", "/new-version", begin_new_version, Right.MANAGE),
)
