"""How a study session ends: completed or cut short, excluded, withdrawn; and the way back.

An exclusion that is known as soon as a participant has finished decides about the place alone. On
withdrawing, the place is given back, and the answers are deleted or kept as was promised.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from typing import Final, Literal, NamedTuple
from urllib.parse import urlencode

from sqlalchemy import delete
from sqlalchemy.orm import Session

from analysis.answers.participant_facts import ParticipantFacts
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import FormAnswer, RefusalLine, StudySession, Trial
from studyapp.researchers.exclusion_decisions import erase_decisions
from studyapp.session.refusal import ConflictError
from studyapp.session.state import current_trial, find_study_session, form_due, state_of, update_row
from studyapp.study.settings.presentation import Page
from studyapp.study.settings.recruitment import Channel, Outcome, Recruitment, draw_code
from studyapp.study.settings.study import Study

JUDGED: Final = ("catch", "attention")
"""Kinds of trial that can be failed, and the rules that count the failures."""


class JudgedTrial(NamedTuple):
    """As much of a stored catch trial or attention check as `Study.failed` must know."""

    kind: str
    part: str
    conditions: tuple[str, ...]
    expected: int | None
    instructed: int | None


def is_excluded(study: Study, study_session: StudySession) -> bool:
    """Tell whether more catch trials or attention checks were failed than the study allows.

    The analysis finds the same from the answers, and applies all other rules besides; here it
    only decides about the place.
    """
    failed = count_failures(study, study_session.trials)
    facts = ParticipantFacts(
        participant=str(study_session.id),
        failed_catch=failed["catch"],
        failed_attention=failed["attention"],
    )
    rules = [each.to_rule() for each in study.settled_exclusions if each.rule in JUDGED]
    return any(rule.judge(facts) for rule in rules)


def count_failures(study: Study, trials: Iterable[Trial]) -> dict[str, int]:
    """Return how many of `trials` were failed, by kind; to leave one out is to fail it."""
    judged = (trial for trial in trials if trial.settled and trial.kind in JUDGED)
    failed = [trial.kind for trial in judged if has_failed(study, trial)]
    return {kind: failed.count(kind) for kind in JUDGED}


def has_failed(study: Study, trial: Trial) -> bool:
    """Tell whether a catch trial or attention check that somebody is done with was failed."""
    if trial.answered_at is None:
        return True
    answers = {(given.question, given.stimulus): given.value for given in trial.responses}
    return study.failed(trial, answers)


MIN_SKIPPED_TRIALS: Final = 2
TRIALS_PER_SKIP: Final = 10


def max_skipped_trials(trials: int) -> int:
    """Return how many of so many trials may be left out since a video does not play."""
    return max(MIN_SKIPPED_TRIALS, trials // TRIALS_PER_SKIP)


def end_as_unwatched(session: Session, study_session: StudySession, now: datetime) -> None:
    """End a study session in which too many videos did not play; its place is free again.

    There is no completion code: whether it is paid is for a person to decide.
    """
    update_row(session, study_session, last_active_at=now, outcome="unwatched")
    study_session.place = None


def advance(session: Session, study_session: StudySession, study: Study, now: datetime) -> None:
    """Note the activity; after the last answer of all, complete the study session.

    Where the study says so, who is excluded opens the place again for somebody else.
    """
    update_row(session, study_session, last_active_at=now)
    if study_session.started_at is None or current_trial(study_session) is not None:
        return
    if form_due(study_session, study) is None:
        study_session.completed_at = now
        study_session.completion_code = draw_code()
        failed = count_failures(study, study_session.trials)["attention"]
        study_session.outcome = study.recruitment.outcome(failed)
        if study.replace_excluded and is_excluded(study, study_session):
            study_session.place = None


Promise = Literal["deleted", "kept"]
"""What becomes of the answers of who withdraws."""


def withdrawal_promise(database: Database, token: str) -> Promise:
    """Return what becomes of the participant's answers on withdrawing.

    Raises
    ------
    ConflictError
        If the study session is finished, or somebody unproven has gone on with it.
    """
    with database.reading() as session:
        study_session = find_study_session(session, token, to_change=False)
        _require_unfinished(study_session)
        return _promise(study_session)


def withdraw(database: Database, token: str, clock: Clock) -> None:
    """Take the consent back: the place is given back, and the answers are not exported.

    Withdrawing twice changes nothing.

    Raises
    ------
    ConflictError
        If the study session is finished, as its completion code may have been used; or if
        somebody went on with it who could not show that they had begun it.
    """
    with database.writing() as session:
        study_session = find_study_session(session, token)
        _require_unfinished(study_session)
        if study_session.withdrawn_at is None:
            end_withdrawn(session, study_session, clock.now())


def end_withdrawn(session: Session, study_session: StudySession, now: datetime) -> None:
    """End `study_session` as withdrawn.

    Where deletion was promised, all that is left is that somebody took part and withdrew: when,
    in which arm, and by which name the recruiter would send them again.
    """
    study_session.withdrawn_at = now
    study_session.place = None
    session.flush()
    if _promise(study_session) == "kept":
        return
    # What hangs on trials goes with them, in the database.
    session.execute(delete(Trial).where(Trial.study_session_id == study_session.id))
    session.execute(delete(FormAnswer).where(FormAnswer.study_session_id == study_session.id))
    erase_decisions(session, study_session.id)
    session.execute(delete(RefusalLine).where(RefusalLine.study_session_id == study_session.id))
    study_session.recruiter_session = study_session.submit_to = ""
    study_session.conditions = []
    study_session.number = None
    if study_session.sound_checked_at is not None:
        study_session.sound_tries = 0  # only who could not hear is told so afterwards
    study_session.started_at = study_session.sound_checked_at = None
    study_session.sound_digits = ""
    study_session.rested_at_position = None
    study_session.last_active_at = now
    session.flush()
    session.expire(study_session)


def _require_unfinished(study_session: StudySession) -> None:
    if study_session.unproven_at is not None and study_session.withdrawn_at is None:
        raise ConflictError(
            "This study was continued by somebody who only knew the participant's name, so nobody "
            "can withdraw here.",
            "To stop, just close this page. To have your answers removed, please write to the "
            "people who run the study.",
        )
    if state_of(study_session) == "completed":
        raise ConflictError(
            "You have already finished the study.",
            "To have your answers removed, please write to the people who run it.",
        )


def _promise(study_session: StudySession) -> Promise:
    """Return what the study promised when this participant agreed, not what it promises now."""
    page = tomllib.loads(study_session.version.definition).get("page", {})
    promised: Promise = page.get("withdrawn", Page.model_fields["withdrawn"].default)
    return promised


PROLIFIC_SITE: Final = "https://app.prolific.com"
PROLIFIC_END: Final = f"{PROLIFIC_SITE}/submissions/complete"

MTURK_SITES: Final = ("https://www.mturk.com", "https://workersandbox.mturk.com")
"""Where the end of an assignment may be reported to; nowhere else."""

MTURK_FRAMES: Final = ("https://worker.mturk.com", *MTURK_SITES)
"""Whose pages show a study in a frame of theirs."""

MTURK_END: Final = "/mturk/externalSubmit"


@dataclass(frozen=True, kw_only=True)
class Exit:
    """What the last page offers.

    Attributes
    ----------
    channel : Channel
        What the page can say of the place they came from.
    outcome : Outcome or None
        How the study session ended; None of somebody who was screened out.
    code : str
        The completion code.
    address : str
        The link back, or where a form goes; empty where there is neither.
    assignment : str
        What a form sends along; empty where a link leads back.
    """

    channel: Channel
    outcome: Outcome | None
    code: str
    address: str = ""
    assignment: str = ""


def exit_of(recruitment: Recruitment, study_session: StudySession) -> Exit | None:
    """Return how the participant of `study_session` leaves; None before the end is stored."""
    own = study_session.completion_code
    if own is None:
        return None
    failed = study_session.outcome == "failed_attention"
    outcome: Outcome = "failed_attention" if failed else "completed"
    # Who came while the study was open to everybody has no place at a recruiter's site.
    if study_session.recruiter_participant is not None:
        if recruitment.channel == "prolific":
            code = recruitment.prolific.code(outcome)
            return Exit(
                channel="prolific",
                outcome=outcome,
                code=code,
                address=prolific_completion_url(code),
            )
        if recruitment.channel == "mturk" and study_session.submit_to in MTURK_SITES:
            return Exit(
                channel="mturk",
                outcome=outcome,
                code=own,
                address=study_session.submit_to + MTURK_END,
                assignment=study_session.recruiter_session,
            )
    channel: Channel = "invitations" if recruitment.channel == "invitations" else "link"
    return Exit(channel=channel, outcome=outcome, code=own)


def screened_out_exit(recruitment: Recruitment) -> Exit:
    """Return how somebody leaves who was screened out, which must be stored before."""
    if recruitment.channel != "prolific":
        return Exit(channel=recruitment.channel, outcome=None, code="")
    code = recruitment.prolific.screened_out
    return Exit(channel="prolific", outcome=None, code=code, address=prolific_completion_url(code))


def return_address(recruitment: Recruitment) -> str:
    """Return the address of where somebody came from who gets no code; empty if there is none.

    They return their place there. A code would pay them, and nothing of them is stored.
    """
    return PROLIFIC_SITE if recruitment.channel == "prolific" else ""


def prolific_completion_url(code: str) -> str:
    """Return the address that tells Prolific of `code`."""
    return f"{PROLIFIC_END}?{urlencode({'cc': code})}"
