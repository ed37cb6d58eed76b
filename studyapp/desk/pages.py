"""All pages of the desk, with the right that each needs, which one guard asks for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

from flask import Blueprint, g, request
from flask.typing import ResponseReturnValue
from werkzeug.exceptions import HTTPException

from motion.errors import InputError
from studyapp.desk import (
    bring_in_page,
    job_page,
    making,
    material_page,
    membership,
    settings_page,
    study_pages,
)
from studyapp.desk.lab import OpenedStudy, current_lab
from studyapp.desk.page import DUTIES, at_the_desk, problem_at_the_desk
from studyapp.researchers.account import Right
from studyapp.web.research import own_account
from studyapp.web.research.page import PREFIX, keep_visitor, problem_page, researcher
from studyapp.web.research.pages import (
    NAME,
    NOWHERE,
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
    *(page for page in OWN_PAGES if page.view is not own_account.log_out),
    *RESEARCHERS_PAGES,
    *VIEWER_FILES,
    *study_pages.LIST_PAGES,
    *membership.PAGES,
    *making.PAGES,
    NOWHERE,
)
"""Pages for which the role at the desk counts."""

STUDY_PAGES: Final[tuple[Page, ...]] = (
    *study_pages.PAGES,
    *settings_page.PAGES,
    *job_page.PAGES,
    *bring_in_page.PAGES,
    *material_page.PAGES,
)
"""Pages of one study, below its page, for which the role in the study counts.

Their views take the opened study in place of its name.
"""


def desk_pages() -> Blueprint:
    """Return the pages, each behind the guard."""
    pages = Blueprint(NAME, __name__, url_prefix=PREFIX, template_folder="templates")
    needed: dict[str, Right | None] = {}
    for page in PAGES:
        pages.add_url_rule(page.rule, view_func=page.view, methods=[page.method])
        needed[page.endpoint] = page.needs
    for page in STUDY_PAGES:
        view = _with_study(page.view)
        pages.add_url_rule(STUDY + page.rule, page.view.__name__, view, methods=[page.method])
        needed[page.endpoint] = Right.KEEP_ACCOUNT
    pages.before_request(guard(needed))
    pages.before_request(_guard_studies({page.endpoint: page.needs for page in STUDY_PAGES}))
    pages.after_request(keep_visitor)
    pages.context_processor(lambda: {"duties": DUTIES})
    pages.add_app_template_filter(at_the_desk)
    pages.register_error_handler(InputError, lambda error: refuse(problem_at_the_desk(error)))
    pages.register_error_handler(HTTPException, fail)
    return pages


def _guard_studies(
    needed: Mapping[str, Right | None],
) -> Callable[[], ResponseReturnValue | None]:
    """Return what lets a request for a study's page through, or answers it."""

    def check_membership() -> ResponseReturnValue | None:
        right = needed.get(request.endpoint or "")
        if right is None:
            return None
        name = (request.view_args or {})["study"]
        g.opened_study = study = current_lab().opened_study(name, researcher())
        if study is None:
            return problem_page(
                "There is no such study among yours",
                "Go on from the list of studies. An owner of the study can make a link by which "
                "you join.",
                404,
            )
        if not study.account.may(right):
            return problem_page(
                "This page is not for your role in the study",
                "An owner of the study can give you another.",
                403,
            )
        return None

    return check_membership


def _with_study(view: Callable[..., ResponseReturnValue]) -> Callable[..., ResponseReturnValue]:
    """Return `view` as Flask calls it, with the study that the guard has opened."""

    def show(study: str, **arguments: Any) -> ResponseReturnValue:
        del study
        opened_study: OpenedStudy = g.opened_study
        return view(opened_study, **arguments)

    return show
