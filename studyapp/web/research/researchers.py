"""Who belongs to the study, for owners."""

from __future__ import annotations

from collections.abc import Callable

from flask import redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.researchers.account import (
    RIGHTS,
    ROLES,
    Role,
    change_role,
    list_accounts,
    remove_access,
    restore_access,
)
from studyapp.researchers.links import (
    invite,
    list_usable_links,
    offer_new_password,
    revoke_link,
)
from studyapp.web.research.page import page, researcher
from studyapp.web.site import current_site


def researchers(problem: InputError | None = None, new_link: str = "", for_name: str = "") -> str:
    """Show the researchers of the study, and the usable links."""
    site = current_site()
    return page(
        "researchers",
        accounts=list_accounts(site.database),
        links=list_usable_links(site.database, site.clock.now()),
        roles=ROLES,
        rights=RIGHTS,
        problem=problem,
        new_link=new_link,
        for_name=for_name,
    )


def invite_researcher() -> ResponseReturnValue:
    """Make an invitation, and show its link this once."""
    site = current_site()
    try:
        token = invite(site.database, site.clock, role=_role(), by=researcher().name)
    except InputError as error:
        return researchers(problem=error), 422
    return researchers(new_link=_link(token))


def offer_password(researcher_id: int) -> ResponseReturnValue:
    """Make a link for a new password, and show it this once."""
    site = current_site()
    names = {account.id: account.name for account in list_accounts(site.database)}
    try:
        name, by = names.get(researcher_id, ""), researcher().name
        token = offer_new_password(site.database, site.clock, name=name, by=by)
    except InputError as error:
        return researchers(problem=error), 422
    return researchers(new_link=_link(token), for_name=name)


def take_link_back(link_id: int) -> ResponseReturnValue:
    """Make a link unusable."""
    site = current_site()
    revoke_link(site.database, site.clock, link_id, by=researcher().name)
    return redirect(url_for("research.researchers"), 303)


def give_role(researcher_id: int) -> ResponseReturnValue:
    """Give a researcher another role."""
    site, by = current_site(), researcher().name
    return _done(
        lambda: change_role(site.database, site.clock, researcher_id, _role(), by=by),
    )


def shut_researcher_out(researcher_id: int) -> ResponseReturnValue:
    """Let a researcher log in no more."""
    site, by = current_site(), researcher().name
    return _done(lambda: remove_access(site.database, site.clock, researcher_id, by=by))


def let_researcher_in(researcher_id: int) -> ResponseReturnValue:
    """Let a researcher log in again."""
    site, by = current_site(), researcher().name
    return _done(lambda: restore_access(site.database, site.clock, researcher_id, by=by))


def _link(token: str) -> str:
    """Return the address of a link.

    It begins with the study's stated origin, or else with the path, which the browser completes:
    the host of a request may be forged.
    """
    return current_site().origin + url_for("research.link", token=token)


def _done(change: Callable[[], None]) -> ResponseReturnValue:
    try:
        change()
    except InputError as error:
        return researchers(problem=error), 422
    return redirect(url_for("research.researchers"), 303)


def _role() -> Role:
    """Return the role that the form names."""
    role = request.form.get("role", "")
    if role not in ROLES:
        raise InputError("there is no such role", remedy=f"Choose one of {', '.join(ROLES)}")
    return role
