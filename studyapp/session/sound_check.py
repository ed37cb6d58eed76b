"""The sound check: a few spoken digits to be typed before anything else. It excludes nobody."""

from __future__ import annotations

import secrets
import unicodedata
from typing import Final

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import StudySession
from studyapp.session.arrival.places import regain_place
from studyapp.session.refusal import ConflictError, UnacceptableError
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import find, state_of
from studyapp.session.withdrawal import take_back

SPOKEN: Final = 3
"""How many digits are spoken."""

TRIES_BEFORE_LEAVING: Final = 3
"""After so many other digits, leaving for want of sound is offered."""


def sound_check_due(study_session: StudySession, served: ServedStudy) -> bool:
    """Tell whether the participant has still to show that the sound is heard."""
    return (
        served.study.page.sound_check
        and served.has_sound
        and state_of(study_session) == "instructed"
        and study_session.sound_checked_at is None
    )


def draw_digits(study_session: StudySession) -> None:
    """Draw what is spoken to this participant, once."""
    if not study_session.sound_digits:
        study_session.sound_digits = "".join(secrets.choice("0123456789") for _ in range(SPOKEN))


def digits_to_speak(database: Database, served: ServedStudy, token: str) -> str:
    """Return the digits that the participant is to hear.

    Raises
    ------
    ConflictError
        If the participant is not at the sound check.
    """
    with database.writing() as session:
        study_session = find(session, token)
        if not sound_check_due(study_session, served):
            raise ConflictError("The sound check is over.", "The next page shows how to go on.")
        draw_digits(study_session)
        return study_session.sound_digits


def check_sound(
    database: Database, served: ServedStudy, token: str, typed: str, clock: Clock
) -> bool:
    """Tell whether what was typed was spoken, and note it; after the check nothing changes.

    Parameters
    ----------
    typed : str
        Digits of any width, with anything between them.

    Raises
    ------
    UnacceptableError
        If no digit was typed.
    """
    digits = "".join(
        str(unicodedata.digit(letter))
        for letter in unicodedata.normalize("NFKC", typed)
        if letter.isdigit()
    )
    with database.writing() as session:
        study_session = find(session, token)
        regain_place(session, served, study_session)
        if not sound_check_due(study_session, served):
            return True
        if not digits:
            raise UnacceptableError(
                "No digits were typed.", "Please play the sound and type the digits you hear."
            )
        study_session.last_active_at = clock.now()
        if digits == study_session.sound_digits:
            study_session.sound_checked_at = clock.now()
            return True
        study_session.sound_tries += 1
        return False


def leave_unheard(database: Database, served: ServedStudy, token: str, clock: Clock) -> None:
    """End the study session of somebody who cannot hear the sound, as if withdrawn.

    It changes nothing before `TRIES_BEFORE_LEAVING` tries, and after the check.
    """
    with database.writing() as session:
        study_session = find(session, token)
        tried = study_session.sound_tries >= TRIES_BEFORE_LEAVING
        if tried and sound_check_due(study_session, served):
            take_back(session, study_session, clock.now())


def left_unheard(study_session: StudySession) -> bool:
    """Tell whether the participant withdrew at the sound check, after trying."""
    return (
        study_session.withdrawn_at is not None
        and study_session.sound_checked_at is None
        and study_session.sound_tries >= TRIES_BEFORE_LEAVING
    )
