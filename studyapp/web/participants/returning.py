"""The participant's cookie: what shows that who comes again by the same name has been here before.

It holds the token of their study session, as the addresses of their pages do, and goes to the
entrance alone. Nothing else needs it, so that a study in a frame of another site, or a browser
without cookies, works without.
"""

from __future__ import annotations

import hashlib
from datetime import timedelta
from typing import Final

from flask import Response, request

KEPT: Final = timedelta(days=7)


def cookie_name(study: str) -> str:
    """Return the cookie's name: two studies on one host, which ports tell apart, have two."""
    return f"participant-{hashlib.sha256(study.encode()).hexdigest()[:8]}"


def read_cookie(study: str) -> str | None:
    """Return the token that the browser sent, None where it sent none."""
    return request.cookies.get(cookie_name(study))


def send_cookie(response: Response, study: str, token: str) -> None:
    """Have the browser keep `token`."""
    response.set_cookie(
        cookie_name(study),
        token,
        max_age=KEPT,
        path=f"{request.script_root}/",
        secure=request.is_secure,
        httponly=True,
        samesite="Lax",
    )
