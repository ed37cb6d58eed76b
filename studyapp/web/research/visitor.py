"""Who asks for a page of researchers, as far as the present request knows."""

from __future__ import annotations

from typing import Final, cast

from flask import Response, abort, g, request

from studyapp.researchers.account import Account
from studyapp.researchers.logins import logged_in
from studyapp.web.research.cookie import form_code, new_visitor, read_cookie, send_cookie
from studyapp.web.running import running

REFRESHED: Final = "refreshed"
"""In the address where a page asks for itself anew: nobody need sit before it."""


def recognise() -> None:
    """Find out who asks, from the cookie."""
    here = running()
    token = read_cookie(here.study.name)
    g.research_cookie = token
    g.research_account = None
    if token is not None:
        by_hand = REFRESHED not in request.args
        g.research_account = logged_in(here.database, token, here.clock.now(), by_hand=by_hand)


def visitor() -> Account | None:
    """Return who is logged in, None for nobody."""
    return cast("Account | None", g.get("research_account"))


def researcher() -> Account:
    """Return who is logged in, on pages that nobody else comes to."""
    found = visitor()
    if found is None:
        abort(403)
    return found


def visitor_cookie() -> str | None:
    """Return the token that the browser sent, None where it sent none."""
    return cast("str | None", g.get("research_cookie"))


def code_for_forms() -> str:
    """Return what the forms of the page must carry; a browser without a cookie gets one."""
    if visitor_cookie() is None:
        g.research_cookie = g.new_research_cookie = new_visitor()
    return form_code(g.research_cookie)


def keep_visitor(response: Response) -> Response:
    """Give a browser that came without a cookie the one that its forms need."""
    if "new_research_cookie" in g:
        send_cookie(response, running().study.name, g.new_research_cookie)
    return response


def with_login(response: Response, token: str | None) -> Response:
    """Have the browser keep the token of a login; without one, a token that stands for nobody."""
    g.pop("new_research_cookie", None)
    send_cookie(response, running().study.name, token or new_visitor())
    return response
