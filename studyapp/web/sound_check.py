"""The sound check: hearing the digits, typing them, and leaving where they cannot be heard."""

from __future__ import annotations

import io

from flask import Blueprint, request, send_file
from flask.typing import ResponseReturnValue

from studyapp.services.refusal import UnacceptableError
from studyapp.services.sound_check import check_sound, digits_to_speak, leave_unheard
from studyapp.web.errors import note, told
from studyapp.web.language import _
from studyapp.web.participant import to_where_they_stand, where_they_stand
from studyapp.web.running import running
from studyapp.web.spoken_digits import spoken

pages = Blueprint("sound_check", __name__)


@pages.get("/take/<token>/sound-check.wav")
def sound(token: str) -> ResponseReturnValue:
    """Read the digits out. Name, size and headers are the same whatever they are."""
    here = running()
    digits = digits_to_speak(here.database, here.served, token)
    # Byte ranges, since one browser plays nothing without them.
    return send_file(
        io.BytesIO(spoken(here.study.page.language, digits)),
        mimetype="audio/wav",
        conditional=True,
        etag=False,
    )


@pages.post("/take/<token>/sound-check")
def check(token: str) -> ResponseReturnValue:
    """Compare what was typed with what was spoken."""
    here = running()
    typed = request.form.get("digits", "")
    try:
        heard = check_sound(here.database, here.served, token, typed, here.clock)
        problem = _("Those are not the digits that were spoken. Please try once more.")
    except UnacceptableError as refusal:
        note(refusal)
        heard, problem = False, told(refusal)
    if heard:
        return to_where_they_stand(token)
    return where_they_stand(token, problem=problem), 422


@pages.post("/take/<token>/sound-check/unheard")
def unheard(token: str) -> ResponseReturnValue:
    """Leave the study without having heard anything."""
    here = running()
    leave_unheard(here.database, here.served, token, here.clock)
    return to_where_they_stand(token)
