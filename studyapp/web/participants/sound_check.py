"""The sound check: digits are read out and typed in."""

import io
import wave
from functools import cache
from pathlib import Path
from typing import Final

from flask import Blueprint, request, send_file
from flask.typing import ResponseReturnValue

from studyapp.session.participation import check_sound, digits_to_speak
from studyapp.session.refusal import UnacceptableError
from studyapp.study.settings.presentation import Language
from studyapp.web.errors import note_and_explain
from studyapp.web.language import _
from studyapp.web.participants.participant import current_page, redirect_to_current_page
from studyapp.web.site import study_site

RECORDINGS: Final = Path(__file__).parents[1] / "digit_recordings"
RATE: Final = 16_000
"""Samples a second of every recording; each is mono, of 16 bits."""

SAMPLE_BYTES: Final = 2
BEFORE_SECONDS: Final = 0.5
"""Silence in which sleeping loudspeakers wake up."""

BETWEEN_SECONDS: Final = 0.4


def spoken_digits(language: Language, digits: str) -> bytes:
    """Return a WAV file in which `digits` are read out.

    Each digit takes the same time, so that files of as many digits have the same size.
    """
    recordings = _recordings(language)
    slot = max(len(recording) for recording in recordings) + _silence(BETWEEN_SECONDS)
    sound = b"".join(recordings[int(digit)].ljust(slot, b"\0") for digit in digits)
    file = io.BytesIO()
    with wave.open(file, "wb") as joined:
        joined.setnchannels(1)
        joined.setsampwidth(SAMPLE_BYTES)
        joined.setframerate(RATE)
        joined.writeframes(b"\0" * _silence(BEFORE_SECONDS) + sound)
    return file.getvalue()


def _silence(seconds: float) -> int:
    """Return how many bytes `seconds` take."""
    return SAMPLE_BYTES * round(seconds * RATE)


@cache
def _recordings(language: Language) -> tuple[bytes, ...]:
    """Return the samples of each digit, 0 first."""
    samples = []
    for digit in range(10):
        with wave.open(str(RECORDINGS / language / f"{digit}.wav"), "rb") as recording:
            samples.append(recording.readframes(recording.getnframes()))
    return tuple(samples)


pages = Blueprint("sound_check", __name__)


@pages.get("/take/<token>/sound-check.wav")
def sound(token: str) -> ResponseReturnValue:
    """Read the digits out. Name, size and headers are the same for all digits."""
    site = study_site()
    digits = digits_to_speak(site.database, site.served, token)
    # One browser plays nothing without byte ranges.
    return send_file(
        io.BytesIO(spoken_digits(site.study.page.language, digits)),
        mimetype="audio/wav",
        conditional=True,
        etag=False,
    )


@pages.post("/take/<token>/sound-check")
def check(token: str) -> ResponseReturnValue:
    """Compare what was typed with what was spoken."""
    site = study_site()
    typed = request.form.get("digits", "")
    try:
        is_right = check_sound(site.database, site.served, token, typed, site.clock)
        problem = _("Those are not the digits that were spoken. Please try once more.")
    except UnacceptableError as refusal:
        is_right, problem = False, note_and_explain(refusal)
    if is_right:
        return redirect_to_current_page(token)
    return current_page(token, problem=problem), 422
