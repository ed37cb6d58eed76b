"""Logging in and out, one-time links, one's own account, and for owners all accounts."""

from collections.abc import Callable
from typing import cast

import segno
from flask import Response, abort, make_response, redirect, request, url_for
from flask.typing import ResponseReturnValue
from markupsafe import Markup

from motion.errors import InputError
from studyapp.researchers.account import (
    RIGHTS,
    ROLES,
    Role,
    change_role,
    list_accounts,
    set_access,
)
from studyapp.researchers.credentials import (
    TooManyAttemptsError,
    disable_second_factor,
    enable_second_factor,
    is_secret,
    new_secret,
    provisioning_uri,
)
from studyapp.researchers.links import (
    Link,
    UnusableLinkError,
    choose_password,
    find_link,
    invite,
    join,
    list_usable_links,
    offer_new_password,
    revoke_link,
)
from studyapp.researchers.logins import WrongLoginError, change_password, end_login, log_in
from studyapp.web.research.page import (
    page,
    refusal_page,
    researcher,
    visitor,
    visitor_cookie,
    with_login,
)
from studyapp.web.site import client_address, current_site


def login() -> ResponseReturnValue:
    """Show the form with name and password, unless somebody is logged in."""
    desk = current_site().desk
    if desk is not None:
        return redirect(desk.address, 303)
    if visitor() is not None:
        return redirect(url_for("research.overview"), 303)
    return page("login", name="", problem=None)


def enter() -> ResponseReturnValue:
    """Log in."""
    site = current_site()
    if site.desk is not None:
        return redirect(site.desk.address, 303)
    name, password, code = (request.form.get(key, "") for key in ("name", "password", "code"))
    try:
        token = log_in(
            site.database,
            site.clock,
            name=name,
            password=password,
            code=code,
            address=client_address(),
        )
    except TooManyAttemptsError as error:
        response = make_response(page("login", name=name, problem=error), 429)
        response.headers["Retry-After"] = str(error.seconds)
        return response
    except WrongLoginError as error:
        return page("login", name=name, problem=error), 403
    return _redirect_with_login(token, url_for("research.overview"))


def log_out() -> ResponseReturnValue:
    """Log out in this browser."""
    token = visitor_cookie()
    if token is not None:
        end_login(current_site().database, token)
    return with_login(cast(Response, redirect(url_for("research.login"), 303)), None)


def link(token: str) -> ResponseReturnValue:
    """Show what a one-time link is for, without using it."""
    return page("link", link=_usable_link(token), token=token, name="", problem=None)


def _usable_link(token: str) -> Link:
    """Return the link; where it is used is at the desk if there is one."""
    site = current_site()
    if site.desk is not None:
        abort(redirect(f"{site.desk.address}join/{token}", 303))
    try:
        return find_link(site.database, token, site.clock.now())
    except UnusableLinkError as error:
        abort(make_response(refusal_page(error, 404)))


def use_link(token: str) -> ResponseReturnValue:
    """Join, or choose a new password, and be logged in."""
    site, usable_link = current_site(), _usable_link(token)
    name, password, again = (request.form.get(key, "") for key in ("name", "password", "again"))
    login_token: str | None
    try:
        _require_same(password, again)
        if usable_link.purpose == "new_password":
            login_token = choose_password(site.database, site.clock, token, password=password)
        else:
            login_token = join(site.database, site.clock, token, name=name, password=password)
    except InputError as error:
        return page("link", link=usable_link, token=token, name=name, problem=error), 422
    if login_token is None:
        return redirect(url_for("research.login"), 303)
    return _redirect_with_login(login_token, url_for("research.overview"))


def _require_same(password: str, again: str) -> None:
    """Raise `InputError` unless a new password was typed twice the same."""
    if password != again:
        raise InputError("the two passwords differ", remedy="Type the new one twice, the same")


def _redirect_with_login(token: str, address: str) -> Response:
    return with_login(cast(Response, redirect(address, 303)), token)


def own_account() -> ResponseReturnValue:
    """Show the researcher's name, rights, and the form for another password."""
    return page("own_account", problem=None, changed="changed" in request.args)


def change_own_password() -> ResponseReturnValue:
    """Change the password; all other browsers are logged out."""
    site = current_site()
    old, new, again = (request.form.get(key, "") for key in ("old", "password", "again"))
    try:
        _require_same(new, again)
        token = change_password(
            site.database,
            site.clock,
            researcher_id=researcher().id,
            old=old,
            new=new,
            address=client_address(),
        )
    except InputError as error:
        return page("own_account", problem=error, changed=False), 422
    return _redirect_with_login(token, url_for("research.own_account", changed=""))


def second_factor() -> ResponseReturnValue:
    """Show the key for a device, and the forms to turn the second factor on or off."""
    return _second_factor_page(new_secret())


def turn_on_second_factor() -> ResponseReturnValue:
    """Require codes from now on, and show the recovery codes once."""
    site = current_site()
    secret, code, password = (request.form.get(key, "") for key in ("secret", "code", "password"))
    try:
        codes = enable_second_factor(
            site.database,
            site.clock,
            researcher().id,
            secret=secret,
            code=code,
            password=password,
            address=client_address(),
        )
    except InputError as error:
        # The device may hold the key already.
        shown = secret if is_secret(secret) else new_secret()
        return _second_factor_page(shown, error), 422
    return page("second_factor", codes=codes)


def turn_off_second_factor() -> ResponseReturnValue:
    """Require no codes any more."""
    site = current_site()
    password = request.form.get("password", "")
    try:
        disable_second_factor(
            site.database,
            site.clock,
            researcher().id,
            password=password,
            address=client_address(),
        )
    except InputError as error:
        return _second_factor_page(new_secret(), error), 422
    return redirect(url_for("research.own_account"), 303)


def _second_factor_page(secret: str, problem: InputError | None = None) -> str:
    address = provisioning_uri(secret, researcher=researcher().name, study=current_site().name)
    picture = Markup(segno.make(address).svg_inline(scale=4, light="white"))  # noqa: S704 - made here of squares
    return page("second_factor", codes=(), secret=secret, picture=picture, problem=problem)


def researchers(new_link: str = "", for_name: str = "") -> str:
    """Show the researchers of the study, and the usable links."""
    site = current_site()
    return page(
        "researchers",
        accounts=list_accounts(site.database),
        links=list_usable_links(site.database, site.clock.now()),
        roles=ROLES,
        rights=RIGHTS,
        new_link=new_link,
        for_name=for_name,
    )


def invite_researcher() -> ResponseReturnValue:
    """Make an invitation, and show its link this once."""
    site = current_site()
    token = invite(site.database, site.clock, role=chosen_role(), by=researcher().name)
    return researchers(new_link=_link(token))


def offer_password(researcher_id: int) -> ResponseReturnValue:
    """Make a link for a new password, and show it this once."""
    site = current_site()
    names = {account.id: account.name for account in list_accounts(site.database)}
    name = names.get(researcher_id, "")
    token = offer_new_password(site.database, site.clock, name=name, by=researcher().name)
    return researchers(new_link=_link(token), for_name=name)


def take_link_back(link_id: int) -> ResponseReturnValue:
    """Make a link unusable."""
    return _done(revoke_link, link_id)


def give_role(researcher_id: int) -> ResponseReturnValue:
    """Give a researcher another role."""
    return _done(change_role, researcher_id, chosen_role())


def shut_researcher_out(researcher_id: int) -> ResponseReturnValue:
    """Let a researcher log in no more."""
    return _done(set_access, researcher_id, allowed=False)


def let_researcher_in(researcher_id: int) -> ResponseReturnValue:
    """Let a researcher log in again."""
    return _done(set_access, researcher_id, allowed=True)


def _link(token: str) -> str:
    """Return the address of a link.

    It begins with the study's stated origin, or else with the path, which the browser completes:
    the host of a request may be forged.
    """
    return current_site().origin + url_for("research.link", token=token)


def _done(change: Callable[..., None], *arguments: object, **more: object) -> ResponseReturnValue:
    """Make a change of accounts or links, and show them."""
    site = current_site()
    change(site.database, site.clock, *arguments, by=researcher().name, **more)
    return redirect(url_for("research.researchers"), 303)


def chosen_role() -> Role:
    """Return the role that the form names.

    Raises
    ------
    InputError
        If there is no such role.
    """
    role = request.form.get("role", "")
    if role not in ROLES:
        raise InputError("there is no such role", remedy=f"Choose one of {', '.join(ROLES)}")
    return role
