"""Before every page of researchers: whether who asks may open it, and the form came from us."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Final

from flask import redirect, request, url_for
from flask.typing import ResponseReturnValue

from studyapp.researchers.roles import Right
from studyapp.web.research.cookie import came_from_our_page
from studyapp.web.research.next_page import asked_page
from studyapp.web.research.page import problem_page
from studyapp.web.research.visitor import recognise, visitor, visitor_cookie

READING: Final = ("GET", "HEAD", "OPTIONS")


def guard(
    needed: Mapping[str, Right | None], harmless: Collection[str] = ()
) -> Callable[[], ResponseReturnValue | None]:
    """Return what lets a request through, or answers it before anything has been done for it.

    Parameters
    ----------
    needed : mapping of endpoint to Right or None
        The right that each page needs; None where nobody need be logged in. A page that is not
        in it is shown to nobody.
    harmless : collection of str
        Endpoints of which nothing comes, so that what is sent to them needs no code.
    """

    def look() -> ResponseReturnValue | None:
        recognise()
        endpoint = request.endpoint or ""
        asks_only = request.method in READING or endpoint in harmless
        if not asks_only and not came_from_our_page(visitor_cookie()):
            return problem_page(
                "This form did not come from a page of this server, or the page was too old",
                "Open the page again and fill the form in once more. The browser must accept "
                "this server's cookie.",
                403,
            )
        right = needed.get(endpoint)
        if right is None and endpoint in needed:
            return None
        account = visitor()
        if account is None:
            return redirect(url_for("research.login", next=asked_page() or None), 303)
        if right is None or not account.may(right):
            return problem_page(
                "This page is not for your role", "An owner of the study can give you another.", 403
            )
        return None

    return look
