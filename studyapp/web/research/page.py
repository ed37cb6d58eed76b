"""What all pages of researchers share: who asks, whose data they show, how they are written.

Before a login the cookie is a random token that stands for nobody; logging in always draws another
one. Each form carries a code that only who knows the cookie can compute, so that no other site can
have a browser send one.
"""

from __future__ import annotations

import hashlib
import hmac
import re
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import Any, Final, Literal, cast

from flask import Response, abort, g, render_template, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.database.engine import Database, sqlite_url
from studyapp.researchers.account import Account, Right
from studyapp.researchers.credentials import new_token
from studyapp.researchers.logins import logged_in
from studyapp.study.folder import StudyFolder
from studyapp.web.site import TokenCookie, current_site, study_site

PREFIX: Final = "/research"
FIELD: Final = "form_code"
HEADER: Final = "Form-Code"
"""Carries the code where a script sends something that is no form."""

TOKEN: Final = re.compile(r"[A-Za-z0-9_-]{43}")


COOKIE: Final = TokenCookie("research", path=PREFIX)
"""Sent to researchers' pages alone, and kept until the browser is closed."""

REFRESHED: Final = "refreshed"
"""In the address where a page asks for itself anew: nobody need sit before it."""

PAGE: Final = re.compile(r"/research/[A-Za-z0-9_/-]*(\?[A-Za-z0-9_=&%.+-]*)?")
LONGEST: Final = 500
NOT_AFTER_LOGIN: Final = ("/research/log-in", "/research/log-out", "/research/join/")


def form_code(token: str) -> str:
    """Return what a form of the browser that has `token` must carry."""
    return hmac.new(token.encode(), b"form", hashlib.sha256).hexdigest()


def came_from_our_page(token: str | None) -> bool:
    """Tell whether the form that was sent came from a page of ours in the same browser."""
    if request.headers.get("Sec-Fetch-Site", "same-origin") != "same-origin":
        return False
    sent = request.headers.get(HEADER) or request.form.get(FIELD, "")
    return token is not None and hmac.compare_digest(sent.encode(), form_code(token).encode())


def recognise() -> None:
    """Find out who asks, from the cookie."""
    site = current_site()
    sent = COOKIE.read(site.name)
    token = sent if sent is not None and TOKEN.fullmatch(sent) else None
    g.research_cookie = token
    g.research_account = None
    if token is not None:
        by_hand = REFRESHED not in request.args
        now = site.clock.now()
        if site.desk is None or logged_in(site.desk.database, token, now, by_hand=by_hand):
            g.research_account = logged_in(site.database, token, now, by_hand=by_hand)


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
        COOKIE.send(response, current_site().name, g.new_research_cookie)
    return response


def with_login(response: Response, token: str | None) -> Response:
    """Have the browser keep the token of a login; without one, a token that stands for nobody."""
    g.pop("new_research_cookie", None)
    COOKIE.send(response, current_site().name, token or new_token())
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


SHARES: Final = ("win_share", "own_speech", "rate")
"""Measures that are parts of a whole."""


def moment(at: datetime) -> str:
    """Return date and time in UTC; the page's script writes them as the browser's clock does."""
    at = at.astimezone(UTC)
    return f"{at.day} {at:%B %Y, %H:%M} UTC"


def clock_time(at: datetime) -> str:
    """Return the time of day with seconds, in UTC."""
    return f"{at.astimezone(UTC):%H:%M:%S}"


def day_or_time(at: datetime, now: datetime) -> str:
    """Return the time alone where it is today, else the date too."""
    at, now = at.astimezone(UTC), now.astimezone(UTC)
    return f"{at:%H:%M} UTC" if at.date() == now.date() else moment(at)


def span(seconds: float) -> str:
    """Return seconds as somebody would say them."""
    if seconds < 60:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest:02} s"
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min"


def share(part: float, whole: float = 1.0) -> str:
    """Return a percentage; a dash where there is no whole."""
    return f"{part / whole:.0%}" if whole else "–"


def figure(value: float | None, measure: str = "") -> str:
    """Return a number with sensible digits; of a share, as a percentage; a dash for none."""
    if value is None:
        return "–"
    return f"{100 * value:.1f}%" if measure in SHARES else _decimal(value)


def interval(low: float | None, high: float | None, measure: str = "") -> str:
    """Return the ends of an interval in words; a dash for none."""
    if low is None or high is None:
        return "–"
    if measure in SHARES:
        return f"{100 * low:.1f} to {100 * high:.1f}%"
    return f"{_decimal(low)} to {_decimal(high)}"


def _decimal(value: float) -> str:
    return f"{value:.2f}".replace("-", "−")


def display_name(name: str) -> str:
    """Return what a condition, an arm or a comparison of the study is called."""
    return study_site().study.display_names.get(name, name)


WORDING: Final = {
    "display_name": display_name,
    "moment": moment,
    "clock_time": clock_time,
    "day_or_time": day_or_time,
    "span": span,
    "share": share,
    "figure": figure,
    "interval": interval,
}


def page(template: str, **values: Any) -> str:
    """Return the page that `template` makes of `values`."""
    return rendered(f"research/{template}.html", **values)


def rendered(file: str, /, **values: Any) -> str:
    """Return what the template `file` makes of `values` and of what all pages show."""
    return render_template(
        file,
        site=current_site(),
        researcher=visitor(),
        Right=Right,
        form_field=FIELD,
        form_code=code_for_forms(),
        **WORDING,
        **values,
    )


def refusal_page(error: InputError, status: int) -> ResponseReturnValue:
    """Return the page that says why something was refused."""
    return problem_page(f"{error.what[:1].upper()}{error.what[1:]}", f"{error.remedy}.", status)


def problem_page(what: str, remedy: str, status: int) -> ResponseReturnValue:
    """Return the page that says what cannot be done, and what can."""
    return page("problem", what=what, remedy=remedy), status


Data = Literal["study", "rehearsal"]

PREFIXES: Final[dict[Data, str]] = {"study": "", "rehearsal": "/rehearsal"}
"""What the addresses of their pages begin with."""


@contextmanager
def looked_at(data: Data) -> Iterator[Database]:
    """Give the database of `data`; that of the rehearsal can only be read.

    Where nothing has been rehearsed, the page does not exist.

    Raises
    ------
    InputError
        If the rehearsal's database cannot be read.
    """
    site = study_site()
    if data == "study":
        yield site.database
        return
    try:
        rehearsed = Database.open_for_reading(sqlite_url(StudyFolder(site.folder).rehearsal))
    except InputError as error:
        raise InputError(
            "the rehearsal cannot be read: it is damaged, or of another version of Motion Jury",
            remedy="Run 'motionjury rehearse' again",
        ) from error
    if rehearsed is None:
        abort(404)
    try:
        yield rehearsed
    finally:
        rehearsed.close()


def is_rehearsed() -> bool:
    """Tell whether there is a rehearsal to be looked at."""
    return StudyFolder(study_site().folder).rehearsal.exists()
