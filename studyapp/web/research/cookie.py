"""The researcher's cookie, and what shows that a form came from a page of ours.

Before a login the cookie is a random token that stands for nobody; logging in always draws another
one. Each form carries a code that only who knows the cookie can compute, so that no other site can
have a browser send one.
"""

from __future__ import annotations

import hashlib
import hmac
import re
from typing import Final

from flask import Response, request

from studyapp.researchers.tokens import new_token

PREFIX: Final = "/research"
FIELD: Final = "form_code"
TOKEN: Final = re.compile(r"[A-Za-z0-9_-]{43}")


def cookie_name(study: str) -> str:
    """Return the cookie's name: two studies on one host, which ports tell apart, have two."""
    return f"research-{hashlib.sha256(study.encode()).hexdigest()[:8]}"


def read_cookie(study: str) -> str | None:
    """Return the token that the browser sent, None where it sent none."""
    sent = request.cookies.get(cookie_name(study), "")
    return sent if TOKEN.fullmatch(sent) else None


def new_visitor() -> str:
    """Return a token for a browser in which nobody is logged in."""
    return new_token()


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
