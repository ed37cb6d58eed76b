"""Who belongs to a study: joining it by a link, with the account one has in it, or as its owner.

A name is no proof. An account in a study is tied to one at the desk where somebody who is logged in
at the desk made the study, used a link that an owner of the study made, or gave the password of the
account in the study; or, of a study that nobody owns, by an owner of the desk.
"""

from __future__ import annotations

from typing import Final

from flask import abort, redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.database.tables import Event
from studyapp.desk.lab import OpenedStudy, current_lab, opened, study_token
from studyapp.desk.page import page
from studyapp.desk.studies import LabStudy
from studyapp.researchers.account import Account, Right, take_identity
from studyapp.researchers.audit import log_change
from studyapp.researchers.credentials import new_token
from studyapp.researchers.links import UnusableLinkError, first_owner_link, join, link_of
from studyapp.researchers.logins import WrongLoginError, begin_login, end_login, log_in, logged_in
from studyapp.web.research import own_account
from studyapp.web.research.page import refusal_page, researcher, visitor_cookie
from studyapp.web.research.pages import Page
from studyapp.web.site import client_address


def enter_study(study: OpenedStudy, token: str) -> None:
    """Log the researcher in in the study, for as long as the desk's login of `token` lasts."""
    lab, own = current_lab(), study_token(token, study.name)
    now = lab.clock.now()
    if logged_in(study.database, own, now, by_hand=True) and logged_in(
        lab.database, own, now, by_hand=True
    ):
        return
    for database, account in (
        (lab.database, researcher()),
        (study.database, study.account),
    ):
        end_login(database, own)
        with database.writing() as session:
            begin_login(session, account.id, now, own)
            if database is study.database:
                log_change(session, now, Event.LOGGED_IN, by=account.name)


def log_out() -> ResponseReturnValue:
    """Log out of the desk, and of all studies that were opened from it in this browser."""
    token = visitor_cookie()
    if token is not None:
        own = [study_token(token, study.name) for study in current_lab().studies()]
        end_login(current_lab().database, *own)
    return own_account.log_out()


def own_study(study: LabStudy, account: Account) -> None:
    """Make the holder of a desk's account the owner of a study that nobody owns.

    Raises
    ------
    InputError
        If somebody owns it.
    """
    clock = current_lab().clock
    token = first_owner_link(study.database, clock)
    if token is None:
        raise InputError(
            f"the study {study.name!r} has an owner", remedy="Ask them for a link to join it"
        )
    # Nobody knows the password: who has come by the desk logs in there.
    join(
        study.database,
        clock,
        token,
        name=account.name,
        password=new_token(),
        identity=account.identity,
    )


def take_over(study: str) -> ResponseReturnValue:
    """Own a study that nobody owns, such as one that was made on the command line."""
    found = current_lab().study(study)
    if found is None:
        abort(404)
    own_study(found, researcher())
    return redirect(url_for("research.study_page", study=study), 303)


def study_link(study: str, token: str) -> ResponseReturnValue:
    """Show what a link of an owner of the study is for."""
    return _link_page(study, token)


def use_study_link(study: str, token: str) -> ResponseReturnValue:
    """Join the study."""
    lab, found = current_lab(), current_lab().study(study)
    try:
        if found is None or link_of(found.database, token, lab.clock.now()).role is None:
            raise UnusableLinkError
        if opened(found, researcher()) is None:
            join(
                found.database,
                lab.clock,
                token,
                name=request.form.get("name", ""),
                password=new_token(),
                identity=researcher().identity,
            )
    except UnusableLinkError as error:
        return refusal_page(error, 404)
    except InputError as error:
        return _link_page(study, token, error)
    return redirect(url_for("research.study_page", study=study), 303)


def _link_page(study: str, token: str, problem: InputError | None = None) -> ResponseReturnValue:
    lab, found = current_lab(), current_lab().study(study)
    try:
        if found is None:
            raise UnusableLinkError
        link = link_of(found.database, token, lab.clock.now())
        if link.role is None:
            # A password is of no use where one logs in at the desk.
            raise UnusableLinkError
    except UnusableLinkError as error:
        return refusal_page(error, 404)
    shown = page("join", link=link, token=token, study=found, problem=problem)
    return shown, 200 if problem is None else 422


def own_account_there() -> ResponseReturnValue:
    """Show the form for an account that one has in a study already."""
    return page("own_account_there", problem=None, study="", name=researcher().name)


def bring_account() -> ResponseReturnValue:
    """Tie an account in a study, whose password is given, to the one at the desk."""
    name, given = request.form.get("study", ""), request.form.get("name", "")
    found, identity = current_lab().study(name.strip()), researcher().identity
    try:
        if found is None or identity is None:
            raise WrongLoginError
        token = log_in(
            found.database,
            current_lab().clock,
            name=given,
            password=request.form.get("password", ""),
            code=request.form.get("code", ""),
            address=client_address(),
        )
        account = logged_in(found.database, token, current_lab().clock.now(), by_hand=True)
        end_login(found.database, token)
        if account is None:
            raise WrongLoginError
        take_identity(found.database, account.id, identity)
    except InputError as error:
        return page("own_account_there", problem=error, study=name, name=given), 403
    return redirect(url_for("research.study_page", study=found.name), 303)


PAGES: Final = (
    Page("POST", "/log-out", log_out, Right.KEEP_ACCOUNT),
    Page("POST", "/studies/<study>/take-over", take_over, Right.MANAGE),
    Page("GET", "/studies/<study>/join/<token>", study_link, Right.KEEP_ACCOUNT),
    Page("POST", "/studies/<study>/join/<token>", use_study_link, Right.KEEP_ACCOUNT),
    Page("GET", "/own-account-there", own_account_there, Right.KEEP_ACCOUNT),
    Page("POST", "/own-account-there", bring_account, Right.KEEP_ACCOUNT),
)
