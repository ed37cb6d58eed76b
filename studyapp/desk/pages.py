"""All pages of the desk, with the right that each needs: one table, asked in one place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from flask import Blueprint, g, request
from flask.typing import ResponseReturnValue
from werkzeug.exceptions import HTTPException

from motion.errors import InputError
from studyapp.desk import (
    belonging,
    bring_in_page,
    job_page,
    list_page,
    making,
    material_page,
    settings_page,
    study_page,
)
from studyapp.desk.lab import OpenedStudy, current_lab
from studyapp.desk.page import DUTIES, Section, StudyPage, at_the_desk, problem_at_the_desk
from studyapp.researchers.account import Right
from studyapp.web.research import own_account
from studyapp.web.research.page import PREFIX, keep_visitor, problem_page, researcher
from studyapp.web.research.pages import (
    NAME,
    OWN_PAGES,
    RESEARCHERS_PAGES,
    VIEWER_FILES,
    Page,
    fail,
    guard,
    refuse,
)

STUDY: Final = "/studies/<study>"

PAGES: Final = (
    *(each for each in OWN_PAGES if each.view is not own_account.log_out),
    *RESEARCHERS_PAGES,
    *VIEWER_FILES,
    *list_page.PAGES,
    *belonging.PAGES,
    *making.PAGES,
    Page("GET", "/<path:rest>", list_page.nowhere, Right.KEEP_ACCOUNT),
)
"""Pages for which the role at the desk counts."""

STUDY_PAGES: Final[tuple[StudyPage, ...]] = (
    *study_page.PAGES,
    *settings_page.PAGES,
    *job_page.PAGES,
    *bring_in_page.PAGES,
    *material_page.PAGES,
)
"""Pages of one study, for which the role in it counts."""

SECTIONS: Final[tuple[Section, ...]] = (*material_page.SECTIONS, *job_page.SECTIONS)
"""Parts of a study's first page, in their order."""


def desk_pages() -> Blueprint:
    """Return the pages, each behind the guard."""
    pages = Blueprint(NAME, __name__, url_prefix=PREFIX, template_folder="templates")
    needed: dict[str, Right | None] = {}
    for page in PAGES:
        pages.add_url_rule(page.rule, view_func=page.view, methods=[page.method])
        needed[f"{NAME}.{page.view.__name__}"] = page.needs
    rights: dict[str, Right] = {}
    for each in STUDY_PAGES:
        name = each.view.__name__
        pages.add_url_rule(STUDY + each.rule, name, _with_study(each.view), methods=[each.method])
        needed[f"{NAME}.{name}"] = Right.KEEP_ACCOUNT
        rights[f"{NAME}.{name}"] = each.needs
    pages.before_request(guard(needed))
    pages.before_request(_guard_studies(rights))
    pages.after_request(keep_visitor)
    pages.context_processor(lambda: {"duties": DUTIES})
    pages.add_app_template_filter(at_the_desk)
    pages.register_error_handler(InputError, lambda error: refuse(problem_at_the_desk(error)))
    pages.register_error_handler(HTTPException, fail)
    return pages


def _guard_studies(rights: dict[str, Right]) -> Callable[[], ResponseReturnValue | None]:
    """Return what lets a request for a study's page through, or answers it."""

    def look() -> ResponseReturnValue | None:
        right = rights.get(request.endpoint or "")
        if right is None:
            return None
        name = (request.view_args or {})["study"]
        g.sections = SECTIONS
        g.opened_study = found = current_lab().study_of(name, researcher())
        if found is None:
            return problem_page(
                "There is no such study among yours",
                "Go on from the list of studies. An owner of the study can make a link by which "
                "you join.",
                404,
            )
        if not found.account.may(right):
            return problem_page(
                "This page is not for your role in the study",
                "An owner of the study can give you another.",
                403,
            )
        return None

    return look


def _with_study(view: Callable[..., ResponseReturnValue]) -> Callable[..., ResponseReturnValue]:
    """Return `view` as Flask calls it, with the study that the guard has opened."""

    def show(study: str, **rest: Any) -> ResponseReturnValue:
        del study
        found: OpenedStudy = g.opened_study
        return view(found, **rest)

    return show
