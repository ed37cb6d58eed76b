"""Who belongs to a study: joining it by a link, or as its owner.

A name is no proof. An account in a study is tied to one at the desk where somebody who is logged in
at the desk made the study, or used a link that an owner of the study made; or, where nobody owns
the study, by an owner of the desk.
"""

from contextlib import suppress
from typing import Final

from flask import abort, make_response, redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.database.tables.researchers import Event
from studyapp.desk.lab import LabStudy, OpenedStudy, current_lab, study_token
from studyapp.desk.page import page
from studyapp.researchers import links, logins
from studyapp.researchers.account import Account, Right
from studyapp.researchers.audit import log_change
from studyapp.researchers.credentials import new_token
from studyapp.web.research import accounts
from studyapp.web.research.page import refusal_page, researcher, visitor_cookie
from studyapp.web.research.pages import Page


def enter_study(study: OpenedStudy, token: str) -> None:
    """Log the researcher in in the study, for as long as the desk's login of `token` lasts."""
    desk, study_login = current_lab(), study_token(token, study.name)
    now = desk.clock.now()
    if all(
        logins.find_account_by_login(database, study_login, now, by_hand=True)
        for database in (desk.database, study.database)
    ):
        return
    for database, account in ((desk.database, researcher()), (study.database, study.account)):
        logins.end_login(database, study_login)
        with database.writing() as session:
            logins.begin_login(session, account.id, now, study_login)
            if database is study.database:
                log_change(session, now, Event.LOGGED_IN, by=account.name)


def log_out() -> ResponseReturnValue:
    """Log out of the desk, and of all studies that were opened from it in this browser."""
    token = visitor_cookie()
    if token is not None:
        lab = current_lab()
        logins.end_login(lab.database, *(study_token(token, study.name) for study in lab.studies()))
    return accounts.log_out()


def own_study(study: LabStudy, account: Account) -> None:
    """Make the holder of a desk's account the owner of a study that nobody owns.

    Raises
    ------
    InputError
        If somebody owns it.
    """
    clock = current_lab().clock
    token = links.first_owner_link(study.database, clock)
    if token is None:
        raise InputError(
            f"the study {study.name!r} has an owner", remedy="Ask them for a link to join it"
        )
    _join(study, token, account.name, account)


def _join(study: LabStudy, token: str, name: str, account: Account) -> None:
    # Nobody knows the password: researchers who come by the desk log in there.
    links.join(
        study.database,
        current_lab().clock,
        token,
        name=name,
        password=new_token(),
        identity=account.identity,
    )


def take_over(study: str) -> ResponseReturnValue:
    """Own a study that nobody owns, such as one that was made on the command line."""
    unowned = current_lab().study(study)
    if unowned is None:
        abort(404)
    own_study(unowned, researcher())
    return redirect(url_for("research.study_page", study=study), 303)


def study_link(study: str, token: str) -> ResponseReturnValue:
    """Show what a link of an owner of the study is for."""
    joinable, link = _invitation(study, token)
    return page("join", link=link, token=token, study=joinable)


def use_study_link(study: str, token: str) -> ResponseReturnValue:
    """Join the study."""
    joinable, link = _invitation(study, token)
    try:
        if current_lab().opened_study(study, researcher()) is None:
            _join(joinable, token, request.form.get("name", ""), researcher())
    except InputError as error:
        return page("join", link=link, token=token, study=joinable, problem=error), 422
    return redirect(url_for("research.study_page", study=study), 303)


def _invitation(name: str, token: str) -> tuple[LabStudy, links.Link]:
    """Return the study that a link of one of its owners is for, and the link."""
    lab = current_lab()
    study = lab.study(name)
    if study is not None:
        with suppress(links.UnusableLinkError):
            link = links.find_link(study.database, token, lab.clock.now())
            # A new password is of no use where one logs in at the desk.
            if link.role is not None:
                return study, link
    abort(make_response(refusal_page(links.UnusableLinkError(), 404)))


PAGES: Final = (
    Page("POST", "/log-out", log_out, Right.KEEP_ACCOUNT),
    Page("POST", "/studies/<study>/take-over", take_over, Right.MANAGE),
    Page("GET", "/studies/<study>/join/<token>", study_link, Right.KEEP_ACCOUNT),
    Page("POST", "/studies/<study>/join/<token>", use_study_link, Right.KEEP_ACCOUNT),
)
