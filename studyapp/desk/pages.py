"""All pages of the desk, with the right that each needs; a study's are asked for as it is opened.

The views here list the studies, show one, and lead into it.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, Final, cast

from flask import Blueprint, Response, abort, current_app, redirect, request, url_for
from flask.typing import ResponseReturnValue
from sqlalchemy.exc import SQLAlchemyError
from werkzeug.exceptions import HTTPException

from motion.errors import InputError
from studyapp.desk import inbox, job_page, making, material_page, membership, settings_page
from studyapp.desk.job_kinds import RUN, TAKE_HOME
from studyapp.desk.lab import OpenedStudy, current_lab, study_token
from studyapp.desk.membership import enter_study
from studyapp.desk.page import DUTIES, at_the_desk, page, problem_at_the_desk, wrong_role
from studyapp.recruitment.invitations import make_test_participation
from studyapp.researchers.account import RIGHTS, ROLES, Right, has_owner
from studyapp.researchers.links import invite
from studyapp.session.served_study import ServedStudy
from studyapp.study.settings.reading import read_study
from studyapp.web.mounting import path_to_try
from studyapp.web.research import accounts
from studyapp.web.research.accounts import chosen_role
from studyapp.web.research.page import (
    COOKIE,
    PREFIX,
    keep_visitor,
    problem_page,
    researcher,
    visitor_cookie,
)
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
    except (InputError, OSError):
        return study.name


def study_page(study: OpenedStudy, new_link: str = "") -> ResponseReturnValue:
    """Show how far a study is, what can be done with it, and a new invitation this once."""
    served = study.study.served()
    address = f"{current_lab().origin}/{study.name}/"
    return page(
        "study",
        study=study,
        title=_title(study),
        new_link=new_link,
        roles=ROLES,
        rights=RIGHTS,
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


def invite_to_study(study: OpenedStudy) -> ResponseReturnValue:
    """Invite a researcher, also while the study has no pages of its own yet."""
    lab, role = current_lab(), chosen_role()
    token = invite(study.study.database, lab.clock, role=role, by=study.account.name)
    link = url_for("research.study_link", study=study.name, token=token)
    return study_page(study, new_link=lab.origin + link)


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
    study.study.begin_new_version(by=study.account.name)
    return redirect(request.path.removesuffix("new-version"), 303)


def _require_served(study: OpenedStudy) -> ServedStudy:
    served = study.study.served()
    if served is None:
        raise InputError(
            "the study cannot be opened yet",
            remedy="Its page at the desk says what is missing",
        )
    return served


STUDY: Final = "/studies/<study>"

PAGES: Final = (
    *(page for page in OWN_PAGES if page.view is not accounts.log_out),
    *RESEARCHERS_PAGES,
    *VIEWER_FILES,
    Page("GET", "/", overview, Right.KEEP_ACCOUNT),
    *membership.PAGES,
    *making.PAGES,
    NOWHERE,
)
"""Pages for which the role at the desk counts."""

STUDY_PAGES: Final[tuple[Page, ...]] = (
    Page("GET", "/", study_page, Right.KEEP_ACCOUNT),
    Page("POST", "/open", open_study_pages, Right.WATCH),
    Page("POST", "/invite", invite_to_study, Right.MANAGE),
    Page("POST", "/try", take_part_as_test, Right.WATCH),
    Page("POST", "/new-version", begin_new_version, Right.MANAGE),
    *settings_page.PAGES,
    *job_page.PAGES,
    *inbox.PAGES,
    *material_page.PAGES,
)
"""Pages of one study, below its page, for which the role in the study counts.

Their views take the opened study in place of its name.
"""


def desk_pages() -> Blueprint:
    """Return the pages, each behind the guard."""
    pages = Blueprint(NAME, __name__, url_prefix=PREFIX, template_folder="templates")
    needed: dict[str, Right | None] = {}
    for each in PAGES:
        pages.add_url_rule(each.rule, view_func=each.view, methods=[each.method])
        needed[each.endpoint] = each.needs
    for each in STUDY_PAGES:
        view, name = _in_study(each), each.view.__name__
        pages.add_url_rule(STUDY + each.rule, name, view, methods=[each.method])
        needed[each.endpoint] = Right.KEEP_ACCOUNT
    pages.before_request(guard(needed))
    pages.after_request(keep_visitor)
    pages.context_processor(lambda: {"duties": DUTIES})
    pages.add_app_template_filter(at_the_desk)
    pages.register_error_handler(InputError, lambda error: refuse(problem_at_the_desk(error)))
    pages.register_error_handler(HTTPException, fail)
    return pages


def _in_study(guarded: Page) -> Callable[..., ResponseReturnValue]:
    """Return the view of a study's page, shown to those whose role in the study allows it."""

    def show(study: str, **arguments: Any) -> ResponseReturnValue:
        opened_study = current_lab().opened_study(study, researcher())
        if opened_study is None:
            return problem_page(
                "There is no such study among yours",
                "Go on from the list of studies. An owner of the study can make a link by which "
                "you join.",
                404,
            )
        if guarded.needs is None or not opened_study.account.may(guarded.needs):
            return wrong_role()
        return guarded.view(opened_study, **arguments)

    return show
