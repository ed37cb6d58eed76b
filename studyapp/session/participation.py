"""A participant's way through the study: the current page, the sound check, and breaks.

In the sound check, participants type a few spoken digits before anything else; it excludes nobody.
Breaks are offered between trials, and end when the participant is ready.
"""

import re
import secrets
import unicodedata
from dataclasses import dataclass, replace
from typing import Final

from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.session.ending import Exit, exit_of
from studyapp.session.places import regain_place
from studyapp.session.refusal import UnacceptableError
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import (
    State,
    current_trial,
    durations_of,
    find_study_session,
    form_due,
    has_tried_comprehension,
    load_videos,
    state_of,
    update_row,
    wrong_page_error,
)
from studyapp.session.trials import (
    ShownTrial,
    expected_seconds,
    following_trials,
    minutes_left,
    shown_trial,
)
from studyapp.study.settings.questions import Stage
from studyapp.study.settings.study import Study


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What a participant's page shows: the first of these that is due.

    Attributes
    ----------
    presentations, practice : int
        Number of trials, and of practice trials.
    sound_tries : int or None
        Number of wrong tries; None if the sound check is not due.
    form : {'demographics', 'closing'} or None
        Questions about the participant that must be answered now.
    break_before : int or None
        Position of the trial before which a break is offered now.
    minutes_left : int or None
        In a break; see `studyapp.session.trials.minutes_left`.
    has_tried_comprehension : bool
        Whether one of the two tries at the questions about the instructions is over.
    exit : Exit or None
        The completion code and the way back; None before the end is stored.
    trial : ShownTrial or None
        The current trial.
    """

    state: State
    presentations: int
    practice: int
    sound_tries: int | None = None
    form: Stage | None = None
    break_before: int | None = None
    minutes_left: int | None = None
    has_tried_comprehension: bool = False
    exit: Exit | None = None
    trial: ShownTrial | None = None

    @property
    def completion_code(self) -> str | None:
        """The completion code; None before the end is stored."""
        return None if self.exit is None else self.exit.code


def load_situation(database: Database, served: ServedStudy, token: str, clock: Clock) -> Situation:
    """Return what the participant's page shows, and mark the current trial as shown.

    A participant who lost the place to a long pause gets it back if it is still open.
    """
    # Nothing loaded here depends on changes made here.
    with database.writing() as session, session.no_autoflush:
        study_session = find_study_session(session, token)
        regain_place(session, served, study_session)
        situation = Situation(
            state=state_of(study_session),
            presentations=len(study_session.trials),
            practice=sum(trial.kind == "practice" for trial in study_session.trials),
            exit=exit_of(served.study.recruitment, study_session),
        )
        if situation.state not in ("instructed", "started"):
            return situation
        now = clock.now()
        update_row(session, study_session, last_active_at=now)
        if sound_check_due(study_session, served):
            # Drawn once: the page may be loaded again.
            study_session.sound_digits = study_session.sound_digits or "".join(
                secrets.choice("0123456789") for _ in range(SPOKEN_DIGITS)
            )
            return replace(situation, sound_tries=study_session.sound_tries)
        form = form_due(study_session, served.study)
        trial = current_trial(study_session)
        if form is not None or situation.state == "instructed" or trial is None:
            has_tried = has_tried_comprehension(study_session)
            return replace(situation, form=form, has_tried_comprehension=has_tried)
        minutes = _minutes_left(session, study_session, served.study)
        if (position := break_due(study_session, served.study)) is not None:
            return replace(situation, break_before=position, minutes_left=minutes)
        trials = study_session.trials
        load_videos(session, [trial, *following_trials(trials, trial)[:1]])
        if trial.shown_at is None:
            update_row(session, trial, shown_at=now)
        return replace(situation, trial=shown_trial(trials, trial, served.study, minutes))


def _minutes_left(session: Session, study_session: StudySession, study: Study) -> int:
    durations = durations_of(session, study_session)
    expected = {
        trial: expected_seconds(durations[trial.id], len(study.asks(trial)))
        for trial in study_session.trials
    }
    return minutes_left(
        [(t.seconds, expected[t]) for t in study_session.trials if t.seconds is not None],
        [expected[trial] for trial in study_session.trials if not trial.settled],
    )


SPOKEN_DIGITS: Final = 3


def sound_check_due(study_session: StudySession, served: ServedStudy) -> bool:
    """Tell whether the participant must still pass the sound check."""
    return (
        served.study.page.sound_check
        and served.has_sound
        and state_of(study_session) == "instructed"
        and study_session.sound_checked_at is None
    )


def digits_to_speak(database: Database, served: ServedStudy, token: str) -> str:
    """Return the digits drawn for the page; `ConflictError` if the sound check is not due."""
    with database.reading() as session:
        study_session = find_study_session(session, token, to_change=False)
        if not sound_check_due(study_session, served):
            raise wrong_page_error()
        return study_session.sound_digits


def check_sound(
    database: Database, served: ServedStudy, token: str, typed: str, clock: Clock
) -> bool:
    """Tell whether the participant typed the spoken digits, and store the result.

    After the check has been passed, nothing changes.

    Parameters
    ----------
    typed : str
        Digits of any width, with anything between them.

    Raises
    ------
    UnacceptableError
        If no digit was typed.
    """
    digits = re.sub(r"[^0-9]", "", unicodedata.normalize("NFKC", typed))
    with database.writing() as session:
        study_session = find_study_session(session, token)
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


def break_due(study_session: StudySession, study: Study) -> int | None:
    """Return the position of the trial before which a break is due now; None for no break.

    A trial that has been shown is never interrupted.
    """
    trial = current_trial(study_session)
    if state_of(study_session) != "started" or trial is None or trial.shown_at is not None:
        return None
    had_break = (study_session.rested_at_position or 0) >= trial.position
    if had_break or not study.page.break_after(trial.position - 1, len(study_session.trials)):
        return None
    return trial.position


def leave_break(
    database: Database, served: ServedStudy, token: str, position: int, clock: Clock
) -> None:
    """End the break before the trial at `position`, if it is the current one."""
    with database.writing() as session:
        study_session = find_study_session(session, token)
        regain_place(session, served, study_session)
        if break_due(study_session, served.study) == position:
            study_session.rested_at_position = position
            study_session.last_active_at = clock.now()
