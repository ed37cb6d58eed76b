"""Excluding a participant from the analysis, and reinstating one."""

from __future__ import annotations

from flask import redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.web.research.visitor import researcher
from studyapp.web.research.watching import study_session_page
from studyapp.web.running import running

DECISIONS = {"exclude": True, "reinstate": False}


def decide_about(number: int) -> ResponseReturnValue:
    """Leave the participant of a study session out of the analysis, or take them in again."""
    here, reason = running(), request.form.get("reason", "")
    try:
        excluded = DECISIONS.get(request.form.get("decision", ""))
        if excluded is None:
            raise InputError("nothing was chosen", remedy=f"Choose one of {', '.join(DECISIONS)}")
        by = researcher().name
        decide_exclusion(here.database, here.clock, number, excluded=excluded, by=by, reason=reason)
    except InputError as error:
        return study_session_page("study", number, problem=error, reason=reason), 422
    return redirect(url_for("research.study_session", data="study", number=number), 303)
