"""Who asks for a page of researchers: the cookie, the code of forms, and where a login leads.

Before a login the cookie is a random token that stands for nobody; logging in always draws another
one. Each form carries a code that only who knows the cookie can compute, so that no other site can
have a browser send one.
"""

from __future__ import annotations

import hashlib
import hmac
import re
from typing import Final, cast

from flask import Response, abort, g, request, url_for

from studyapp.researchers.account import Account
from studyapp.researchers.logins import logged_in
from studyapp.researchers.tokens import new_token
from studyapp.web.running import running

PREFIX: Final = "/research"
FIELD: Final = "form_code"
TOKEN: Final = re.compile(r"[A-Za-z0-9_-]{43}")

REFRESHED: Final = "refreshed"
"""In the address where a page asks for itself anew: nobody need sit before it."""

PAGE: Final = re.compile(r"/research/[A-Za-z0-9_/-]*(\?[A-Za-z0-9_=&%.+-]*)?")
LONGEST: Final = 500
NOT_AFTER_LOGIN: Final = ("/research/log-in", "/research/log-out", "/research/join/")


def cookie_name(study: str) -> str:
    """Return the cookie's name: two studies on one host, which ports tell apart, have two."""
    return f"research-{hashlib.sha256(study.encode()).hexdigest()[:8]}"


def read_cookie(study: str) -> str | None:
    """Return the token that the browser sent, None where it sent none."""
    sent = request.cookies.get(cookie_name(study), "")
    return sent if TOKEN.fullmatch(sent) else None


def send_cookie(response: Response, study: str, token: str) -> None:
    """Have the browser keep `token` until it is closed, and send it to researchers' pages alone."""
    response.set_cookie(
        cookie_name(study),
        token,
        path=request.script_root + PREFIX,
        secure=request.is_secure,
        httponly=True,
        samesite="Lax",
    )


def form_code(token: str) -> str:
    """Return what a form of the browser that has `token` must carry."""
    return hmac.new(token.encode(), b"form", hashlib.sha256).hexdigest()


def came_from_our_page(token: str | None) -> bool:
    """Tell whether the form that was sent came from a page of ours in the same browser."""
    if request.headers.get("Sec-Fetch-Site", "same-origin") != "same-origin":
        return False
    sent = request.form.get(FIELD, "")
    return token is not None and hmac.compare_digest(sent.encode(), form_code(token).encode())


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
        g.research_cookie = g.new_research_cookie = new_token()
    return form_code(g.research_cookie)


def keep_visitor(response: Response) -> Response:
    """Give a browser that came without a cookie the one that its forms need."""
    if "new_research_cookie" in g:
        send_cookie(response, running().study.name, g.new_research_cookie)
    return response


def with_login(response: Response, token: str | None) -> Response:
    """Have the browser keep the token of a login; without one, a token that stands for nobody."""
    g.pop("new_research_cookie", None)
    send_cookie(response, running().study.name, token or new_token())
    return response


def asked_page() -> str:
    """Return what is asked for, to come back to after logging in; empty where nothing can be."""
    if request.method != "GET":
        return ""
    asked = request.path if REFRESHED in request.args else request.full_path.removesuffix("?")
    return asked if _is_ours(asked) else ""


def address_after_login(wanted: str) -> str:
    """Return the address of the page `wanted`; of the overview where it is none of ours."""
    if _is_ours(wanted):
        return request.script_root + wanted
    return url_for("research.overview")


def _is_ours(page: str) -> bool:
    inside = PAGE.fullmatch(page) is not None and "//" not in page and len(page) <= LONGEST
    return inside and not page.startswith(NOT_AFTER_LOGIN)
