"""What all pages of researchers share: the visitor, the data they show, and their wording.

Before a login the cookie is a random token that stands for nobody; logging in always draws a new
one. Each form carries a code that follows from the cookie, so that no other site can have a browser
send one.
"""

import hashlib
import hmac
import re
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import Any, Final, Literal, cast

from flask import Response, abort, g, render_template, request
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.database.engine import Database, sqlite_url
from studyapp.researchers.account import Account, Right
from studyapp.researchers.credentials import new_token
from studyapp.researchers.logins import find_account_by_login
from studyapp.study.folder import StudyFolder
from studyapp.web.site import TokenCookie, current_site, study_site

PREFIX: Final = "/research"
FIELD: Final = "form_code"
HEADER: Final = "Form-Code"
"""The header in which scripts send the code."""

TOKEN: Final = re.compile(r"[A-Za-z0-9_-]{43}")


COOKIE: Final = TokenCookie("research", path=PREFIX)
"""Sent to researchers' pages alone, and kept until the browser is closed."""

REFRESHED: Final = "refreshed"
"""In the address if a page refreshes itself, which does not show that anybody is there."""


def form_code(token: str) -> str:
    """Return the code that forms must carry in the browser with `token`."""
    return hmac.new(token.encode(), b"form", hashlib.sha256).hexdigest()


def came_from_our_page(token: str | None) -> bool:
    """Return whether the form came from a page of this server in the same browser."""
    if request.headers.get("Sec-Fetch-Site", "same-origin") != "same-origin":
        return False
    sent = request.headers.get(HEADER) or request.form.get(FIELD, "")
    return token is not None and hmac.compare_digest(sent.encode(), form_code(token).encode())


def recognise() -> None:
    """Identify the visitor by the cookie."""
    site = current_site()
    sent = COOKIE.read(site.name)
    token = sent if sent is not None and TOKEN.fullmatch(sent) else None
    g.research_cookie = token
    g.research_account = None
    if token is not None:
        by_hand = REFRESHED not in request.args
        now = site.clock.now()
        if site.desk is None or find_account_by_login(
            site.desk.database, token, now, by_hand=by_hand
        ):
            g.research_account = find_account_by_login(site.database, token, now, by_hand=by_hand)


def visitor() -> Account | None:
    """Return the account that is logged in, if any."""
    return cast("Account | None", g.get("research_account"))


def researcher() -> Account:
    """Return the account that is logged in, on pages that require one."""
    account = visitor()
    if account is None:
        abort(403)
    return account


def visitor_cookie() -> str | None:
    """Return the token that the browser sent, if any."""
    return cast("str | None", g.get("research_cookie"))


def code_for_forms() -> str:
    """Return the code for the page's forms; a browser without a cookie gets one."""
    if visitor_cookie() is None:
        g.research_cookie = g.new_research_cookie = new_token()
    return form_code(g.research_cookie)


def keep_visitor(response: Response) -> Response:
    """Send the cookie that the forms need to a browser that had none."""
    if "new_research_cookie" in g:
        COOKIE.send(response, current_site().name, g.new_research_cookie)
    return response


def with_login(response: Response, token: str | None) -> Response:
    """Have the browser keep the token of a login, or else one that stands for nobody."""
    g.pop("new_research_cookie", None)
    COOKIE.send(response, current_site().name, token or new_token())
    return response


def moment(at: datetime) -> str:
    """Return date and time in UTC; a script on the page converts them to local time."""
    at = at.astimezone(UTC)
    return f"{at.day} {at:%B %Y, %H:%M} UTC"


def clock_time(at: datetime) -> str:
    """Return the time of day with seconds, in UTC."""
    return f"{at.astimezone(UTC):%H:%M:%S}"


def day_or_time(at: datetime, now: datetime) -> str:
    """Return the time of day, with the date if it is not today's."""
    at, now = at.astimezone(UTC), now.astimezone(UTC)
    return f"{at:%H:%M} UTC" if at.date() == now.date() else moment(at)


def span(seconds: float) -> str:
    """Return a duration in words."""
    if seconds < 60:
        return f"{seconds:.1f} s"
    minutes, seconds = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {seconds:02} s"
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min"


def share(part: float, whole: float = 1.0) -> str:
    """Return a percentage; a dash if the whole is 0."""
    return f"{part / whole:.0%}" if whole else "–"


def figure(value: float | None, measure: str = "") -> str:
    """Return a number as the report writes it, or a rate as a percentage; a dash for None.

    Shares and coefficients have no leading zero, '.63'; mean ratings and ranks do, '0.63'.
    """
    if value is None:
        return "–"
    if measure == "rate":
        return f"{value:.1%}"
    # Zero has no sign.
    text = f"{round(value, 2) + 0:.2f}".replace("-", "−")
    return text if measure.startswith("mean_") else re.sub(r"^(−?)0\.", r"\1.", text)


def interval(low: float | None, high: float | None, measure: str = "") -> str:
    """Return the ends of an interval, '[.55, .71]'; a dash for None."""
    if low is None or high is None:
        return "–"
    return f"[{figure(low, measure)}, {figure(high, measure)}]"


def question_name(question: str) -> str:
    """Return the name of a question as a heading, as the report writes it."""
    text = question.replace("_", " ")
    return text[:1].upper() + text[1:]


def display_name(name: str) -> str:
    """Return the display name of a condition, an arm or a comparison."""
    return study_site().study.display_names.get(name, name)


WORDING: Final = {
    "display_name": display_name,
    "question_name": question_name,
    "moment": moment,
    "clock_time": clock_time,
    "day_or_time": day_or_time,
    "span": span,
    "share": share,
    "figure": figure,
    "interval": interval,
}


def page(template: str, **values: Any) -> str:
    """Return the page of ``research/<template>.html`` with `values`."""
    return rendered(f"research/{template}.html", **values)


def rendered(file: str, /, **values: Any) -> str:
    """Return the template `file` with `values` and with what all pages show."""
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
    """Return the page that explains a refusal."""
    return problem_page(f"{error.what[:1].upper()}{error.what[1:]}", f"{error.remedy}.", status)


def problem_page(what: str, remedy: str, status: int) -> ResponseReturnValue:
    """Return the page that says what is wrong, and what to do."""
    return page("problem", what=what, remedy=remedy), status


Data = Literal["study", "rehearsal"]

PREFIXES: Final[dict[Data, str]] = {"study": "", "rehearsal": "/rehearsal"}
"""Prefixes of the addresses of their pages."""


@contextmanager
def open_data(data: Data) -> Iterator[Database]:
    """Give the database of `data`; the rehearsal's can only be read.

    The page does not exist if nothing has been rehearsed.

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
    """Return whether there is a rehearsal to show."""
    return StudyFolder(study_site().folder).rehearsal.exists()
