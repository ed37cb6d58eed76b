"""Rendering researchers' pages, and how they write moments and numbers."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any, Final

from flask import render_template
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.researchers.account import Right
from studyapp.web.research.visitor import FIELD, code_for_forms, visitor
from studyapp.web.running import running

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
    return f"{100 * value:.1f} %" if measure in SHARES else _decimal(value)


def interval(low: float | None, high: float | None, measure: str = "") -> str:
    """Return the ends of an interval in words; a dash for none."""
    if low is None or high is None:
        return "–"
    if measure in SHARES:
        return f"{100 * low:.1f} to {100 * high:.1f} %"
    return f"{_decimal(low)} to {_decimal(high)}"


def _decimal(value: float) -> str:
    return f"{value:.2f}".replace("-", "−")


WORDING: Final = {
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
    return render_template(
        f"research/{template}.html",
        study=running().study,
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
