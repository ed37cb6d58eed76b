"""A researcher's own account."""

from __future__ import annotations

from typing import cast

import segno
from flask import Response, redirect, request, url_for
from flask.typing import ResponseReturnValue
from markupsafe import Markup

from motion.errors import InputError
from studyapp.researchers.authentication import change_password
from studyapp.researchers.second_factor import (
    address_for_device,
    new_secret,
    turn_off,
    turn_on,
)
from studyapp.web.address import client_address
from studyapp.web.research.entering import require_same
from studyapp.web.research.page import page
from studyapp.web.research.visitor import researcher, with_login
from studyapp.web.running import running


def own_account() -> ResponseReturnValue:
    """Show who one is, what one may do, and the form for another password."""
    return page("own_account", problem=None, changed="changed" in request.args)


def change_own_password() -> ResponseReturnValue:
    """Change the password; all other browsers are logged out."""
    here = running()
    old, new, again = (request.form.get(key, "") for key in ("old", "password", "again"))
    try:
        require_same(new, again)
        token = change_password(
            here.database,
            here.clock,
            researcher_id=researcher().id,
            old=old,
            new=new,
            address=client_address(),
        )
    except InputError as error:
        return page("own_account", problem=error, changed=False), 422
    done = redirect(url_for("research.own_account", changed=""), 303)
    return with_login(cast(Response, done), token)


def second_factor() -> ResponseReturnValue:
    """Show the key for a device, and the forms to turn the second factor on or off."""
    return _second_factor_page(new_secret())


def turn_on_second_factor() -> ResponseReturnValue:
    """Ask for codes from now on, and show the recovery codes once."""
    here = running()
    secret, code, password = (request.form.get(key, "") for key in ("secret", "code", "password"))
    try:
        codes = turn_on(
            here.database,
            here.clock,
            researcher().id,
            secret=secret,
            code=code,
            password=password,
            address=client_address(),
        )
    except InputError as error:
        return _second_factor_page(new_secret(), error), 422
    return page("second_factor", codes=codes)


def turn_off_second_factor() -> ResponseReturnValue:
    """Ask for no codes any more."""
    here = running()
    password = request.form.get("password", "")
    try:
        turn_off(
            here.database,
            here.clock,
            researcher().id,
            password=password,
            address=client_address(),
        )
    except InputError as error:
        return _second_factor_page(new_secret(), error), 422
    return redirect(url_for("research.own_account"), 303)


def _second_factor_page(secret: str, problem: InputError | None = None) -> str:
    named = address_for_device(secret, researcher=researcher().name, study=running().study.name)
    picture = Markup(segno.make(named).svg_inline(scale=4))  # noqa: S704 - made here of squares
    return page("second_factor", codes=(), secret=secret, picture=picture, problem=problem)
