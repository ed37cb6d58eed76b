"""Rendering researchers' pages, which all say where one is and who one is."""

from __future__ import annotations

from typing import Any, Final

from flask import render_template
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.researchers.roles import Right
from studyapp.web.research import wording
from studyapp.web.research.cookie import FIELD
from studyapp.web.research.visitor import code_for_forms, visitor
from studyapp.web.running import running

WORDING: Final = {
    "moment": wording.moment,
    "clock_time": wording.clock_time,
    "day_or_time": wording.day_or_time,
    "span": wording.span,
    "share": wording.share,
    "figure": wording.figure,
    "interval": wording.interval,
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
