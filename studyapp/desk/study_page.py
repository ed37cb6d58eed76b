"""A study's first page at the desk, and the ways from there into the study."""

from __future__ import annotations

from typing import Final, cast

from flask import Response, g, redirect, request
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.desk.belonging import enter_study
from studyapp.desk.lab import OpenedStudy, current_lab, study_token
from studyapp.desk.list_page import title_of
from studyapp.desk.page import StudyPage, page
from studyapp.recruitment.invitations import make_test_participation
from studyapp.researchers.account import Right
from studyapp.web.mounting import path_to_try
from studyapp.web.research.page import COOKIE, visitor_cookie


def study_page(study: OpenedStudy) -> ResponseReturnValue:
    """Show how far a study is, and what can be done with it."""
    served = study.study.served()
    address = f"{current_lab().origin}/{study.name}/"
    return page(
        "study",
        study=study,
        title=title_of(study),
        standing=study.study.standing(),
        link="" if served is None else served.study.recruitment.link(address),
        shown=[
            (section, section.told(study))
            for section in g.sections
            if study.account.may(section.needs)
        ],
    )


WAYS: Final = ("", "preview", "study-sessions", "newcomers", "results", "researchers", "changes")
"""Pages of the study itself that its page at the desk leads to."""


def open_study_pages(study: OpenedStudy) -> ResponseReturnValue:
    """Go on to the study's own pages, logged in there."""
    way, token = request.form.get("way", ""), visitor_cookie()
    served = study.study.served()
    if served is None or token is None:
        raise _not_ready()
    enter_study(study, token)
    to = f"/{study.name}/research/{way if way in WAYS else ''}"
    answer = cast(Response, redirect(to, 303))
    own = study_token(token, study.name)
    COOKIE.send(answer, served.study.name, own, below=f"/{study.name}")
    return answer


def take_part_as_test(study: OpenedStudy) -> ResponseReturnValue:
    """Let the researcher take part in the study; nothing of it counts."""
    served = study.study.served()
    if served is None:
        raise _not_ready()
    own = make_test_participation(
        study.folder.root, served, current_lab().clock, by=study.account.name
    )
    return redirect(f"/{study.name}{path_to_try(own)}", 303)


def begin_new_version(study: OpenedStudy) -> ResponseReturnValue:
    """Serve what the study file says as a new version."""
    study.study.begin_new_version()
    return redirect(request.path.removesuffix("new-version"), 303)


def _not_ready() -> InputError:
    return InputError(
        "the study cannot be opened yet",
        remedy="Its page at the desk says what is missing",
    )


PAGES: Final = (
    StudyPage("GET", "/", study_page, Right.KEEP_ACCOUNT),
    StudyPage("POST", "/open", open_study_pages, Right.WATCH),
    StudyPage("POST", "/try", take_part_as_test, Right.WATCH),
    StudyPage("POST", "/new-version", begin_new_version, Right.MANAGE),
)
