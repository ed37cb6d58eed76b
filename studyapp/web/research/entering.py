"""Logging in and out, and the pages of one-time links."""

from __future__ import annotations

from typing import cast

from flask import Response, make_response, redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.researchers.attempts import TooManyAttemptsError
from studyapp.researchers.authentication import WrongLoginError, log_in
from studyapp.researchers.links import (
    UnusableLinkError,
    choose_password,
    join,
    link_of,
)
from studyapp.researchers.logins import end_login
from studyapp.web.address import client_address
from studyapp.web.research.page import page, refusal_page
from studyapp.web.research.visitor import address_after_login, visitor, visitor_cookie, with_login
from studyapp.web.running import running


def login() -> ResponseReturnValue:
    """Show the form with name and password; who is logged in goes on."""
    wanted = request.args.get("next", "")
    if visitor() is not None:
        return redirect(address_after_login(wanted), 303)
    return page("login", wanted=wanted, name="", problem=None)


def enter() -> ResponseReturnValue:
    """Log in."""
    here = running()
    name, password, code, wanted = (
        request.form.get(key, "") for key in ("name", "password", "code", "next")
    )
    try:
        token = log_in(
            here.database,
            here.clock,
            name=name,
            password=password,
            code=code,
            address=client_address(),
        )
    except TooManyAttemptsError as error:
        refused = make_response(page("login", wanted=wanted, name=name, problem=error), 429)
        refused.headers["Retry-After"] = str(error.seconds)
        return refused
    except WrongLoginError as error:
        return page("login", wanted=wanted, name=name, problem=error), 403
    return _entered(token, address_after_login(wanted))


def log_out() -> ResponseReturnValue:
    """Log out in this browser."""
    token = visitor_cookie()
    if token is not None:
        end_login(running().database, token)
    return with_login(cast(Response, redirect(url_for("research.login"), 303)), None)


def link(token: str) -> ResponseReturnValue:
    """Show what a one-time link is for; looking at it does not use it."""
    here = running()
    try:
        found = link_of(here.database, token, here.clock.now())
    except UnusableLinkError as error:
        return refusal_page(error, 404)
    return page("link", link=found, token=token, name="", problem=None)


def use_link(token: str) -> ResponseReturnValue:
    """Join, or choose a new password, and be logged in."""
    here = running()
    name, password, again = (request.form.get(key, "") for key in ("name", "password", "again"))
    login_token: str | None
    try:
        found = link_of(here.database, token, here.clock.now())
    except UnusableLinkError as error:
        return refusal_page(error, 404)
    try:
        require_same(password, again)
        if found.purpose == "new_password":
            login_token = choose_password(here.database, here.clock, token, password=password)
        else:
            login_token = join(here.database, here.clock, token, name=name, password=password)
    except InputError as error:
        return page("link", link=found, token=token, name=name, problem=error), 422
    if login_token is None:
        return redirect(url_for("research.login"), 303)
    return _entered(login_token, url_for("research.overview"))


def require_same(password: str, again: str) -> None:
    """Raise `InputError` unless a new password was typed the same twice."""
    if password != again:
        raise InputError("the two passwords differ", remedy="Type the new one twice, the same")


def _entered(token: str, address: str) -> Response:
    return with_login(cast(Response, redirect(address, 303)), token)
