"""Withdrawing, at any time before the end."""

from __future__ import annotations

from flask import Blueprint, render_template
from flask.typing import ResponseReturnValue

from studyapp.session.withdrawal import promise_made, withdraw
from studyapp.web.participants.participant import to_where_they_stand
from studyapp.web.running import running

pages = Blueprint("withdrawal", __name__)


@pages.get("/take/<token>/withdraw")
def ask(token: str) -> ResponseReturnValue:
    """Ask whether the participant really wants to stop, and say what becomes of the answers."""
    here = running()
    promise = promise_made(here.database, token)
    return render_template("withdraw.html", study=here.study, token=token, promise=promise)


@pages.post("/take/<token>/withdraw")
def confirm(token: str) -> ResponseReturnValue:
    """Take the consent back."""
    here = running()
    withdraw(here.database, token, here.clock)
    return to_where_they_stand(token)
