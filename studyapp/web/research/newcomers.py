"""Pausing, resuming, extending and closing the study."""

from __future__ import annotations

from flask import redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.session.arrival.intake import STATES
from studyapp.session.arrival.intake_decisions import MOST_MORE, decided, extend, steer
from studyapp.web.research.page import page
from studyapp.web.research.visitor import researcher
from studyapp.web.running import running


def newcomers() -> ResponseReturnValue:
    """Show whether newcomers are let in, who decided so, and the forms to decide otherwise."""
    return _page()


def steer_newcomers() -> ResponseReturnValue:
    """Let newcomers in, or no longer."""
    here, reason, sent = running(), request.form.get("reason", ""), request.form.get("state")
    state = next((known for known in STATES if known == sent), None)
    try:
        if state is None:
            raise InputError("nothing was chosen", remedy=f"Choose one of {', '.join(STATES)}")
        by = researcher().name
        steer(here.database, here.served, here.clock, state, by=by, reason=reason)
    except InputError as error:
        return _page(error, reason), 422
    return redirect(url_for("research.newcomers"), 303)


def want_more() -> ResponseReturnValue:
    """Open more places in every arm."""
    here, reason, sent = running(), request.form.get("reason", ""), request.form.get("more", "")
    readable = sent.isascii() and sent.isdecimal() and len(sent) <= len(str(MOST_MORE))
    try:
        more, by = int(sent) if readable else 0, researcher().name
        extend(here.database, here.served, here.clock, more, by=by, reason=reason)
    except InputError as error:
        return _page(error, reason), 422
    return redirect(url_for("research.newcomers"), 303)


def _page(problem: InputError | None = None, reason: str = "") -> str:
    made = decided(running().database)
    state = made[0].state if made else "open"
    return page("newcomers", made=made, state=state, problem=problem, reason=reason, most=MOST_MORE)
