"""The end of a study session: completion, exclusion, withdrawal, and the way back to a recruiter.

An exclusion at the end only decides about the place. Withdrawal releases the place, and deletes or
keeps the answers as the study promised.
"""

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from typing import Final, Literal, NamedTuple
from urllib.parse import urlencode

from sqlalchemy import delete
from sqlalchemy.orm import Session

from analysis.answers.exclusion_rules import ParticipantFacts
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import FormAnswer, RefusalLine, StudySession
from studyapp.database.tables.trial import Trial
from studyapp.researchers.exclusion_decisions import erase_decisions
from studyapp.session.refusal import ConflictError
from studyapp.session.state import current_trial, find_study_session, form_due, state_of, update_row
from studyapp.study.settings.presentation import Page
from studyapp.study.settings.recruitment import Channel, Outcome, Recruitment, draw_code
from studyapp.study.settings.study import Study

JUDGED: Final = ("catch", "attention")
"""Kinds of trial that can be failed, and names of the exclusion rules that count failures."""


class JudgedTrial(NamedTuple):
    """What `Study.failed` needs to know of a stored catch trial or attention check."""

    kind: str
    part: str
    conditions: tuple[str, ...]
    expected: int | None
    instructed: int | None


def is_excluded(study: Study, study_session: StudySession) -> bool:
    """Tell whether the participant failed too many catch trials or attention checks.

    It decides about the place; the analysis judges the answers again, by all rules.
    """
    failures = count_failures(study, study_session.trials)
    facts = ParticipantFacts(
        participant=str(study_session.id),
        failed_catch=failures["catch"],
        failed_attention=failures["attention"],
    )
    rules = [rule.to_rule() for rule in study.settled_exclusions if rule.rule in JUDGED]
    return any(rule.judge(facts) for rule in rules)


def count_failures(study: Study, trials: Iterable[Trial]) -> dict[str, int]:
    """Count the failed trials by kind; a skipped one is failed."""
    judged = (trial for trial in trials if trial.settled and trial.kind in JUDGED)
    failed = [trial.kind for trial in judged if has_failed(study, trial)]
    return {kind: failed.count(kind) for kind in JUDGED}


def has_failed(study: Study, trial: Trial) -> bool:
    """Tell whether a settled catch trial or attention check was failed."""
    if trial.answered_at is None:
        return True
    answers = {(each.question, each.stimulus): each.value for each in trial.responses}
    return study.failed(trial, answers)


MIN_SKIPPED_TRIALS: Final = 2
TRIALS_PER_SKIP: Final = 10


def max_skipped_trials(trials: int) -> int:
    """Return how many of so many trials a participant may skip because a video does not play."""
    return max(MIN_SKIPPED_TRIALS, trials // TRIALS_PER_SKIP)


def end_as_unwatched(session: Session, study_session: StudySession, now: datetime) -> None:
    """End a study session in which too many videos did not play, and release its place.

    There is no completion code: a researcher decides about pay.
    """
    update_row(session, study_session, last_active_at=now, outcome="unwatched")
    study_session.place = None


def advance(session: Session, study_session: StudySession, study: Study, now: datetime) -> None:
    """Store the activity; after the very last answer, complete the study session.

    If the study replaces excluded participants, their places are released.
    """
    update_row(session, study_session, last_active_at=now)
    if study_session.started_at is None or current_trial(study_session) is not None:
        return
    if form_due(study_session, study) is None:
        study_session.completed_at = now
        study_session.completion_code = draw_code()
        failed_checks = count_failures(study, study_session.trials)["attention"]
        study_session.outcome = study.recruitment.outcome(failed_checks)
        if study.replace_excluded and is_excluded(study, study_session):
            study_session.place = None


Promise = Literal["deleted", "kept"]
"""What happens to the answers on withdrawal."""


def withdrawal_promise(database: Database, token: str) -> Promise | None:
    """Return what happens to the participant's answers on withdrawal; None if they have withdrawn.

    Raises
    ------
    ConflictError
        As in `withdraw`.
    """
    with database.reading() as session:
        study_session = find_study_session(session, token, to_change=False)
        _require_unfinished(study_session)
        return None if study_session.withdrawn_at is not None else _promise(study_session)


def withdraw(database: Database, token: str, clock: Clock) -> None:
    """Withdraw the consent: the place is released, and the answers are not exported.

    Withdrawing twice changes nothing.

    Raises
    ------
    ConflictError
        If the study session is finished, as its completion code may have been used; or if
        somebody without proof has resumed it.
    """
    with database.writing() as session:
        study_session = find_study_session(session, token)
        _require_unfinished(study_session)
        if study_session.withdrawn_at is None:
            _end_withdrawn(session, study_session, clock.now())


def _end_withdrawn(session: Session, study_session: StudySession, now: datetime) -> None:
    """End `study_session` as withdrawn.

    If deletion was promised, all that remains is that somebody took part and withdrew: when, in
    which arm, and under which recruiter's name.
    """
    study_session.withdrawn_at = now
    study_session.place = None
    session.flush()
    if _promise(study_session) == "kept":
        return
    # The database deletes what belongs to the trials.
    session.execute(delete(Trial).where(Trial.study_session_id == study_session.id))
    session.execute(delete(FormAnswer).where(FormAnswer.study_session_id == study_session.id))
    erase_decisions(session, study_session.id)
    session.execute(delete(RefusalLine).where(RefusalLine.study_session_id == study_session.id))
    study_session.recruiter_session = study_session.submit_to = ""
    study_session.conditions = []
    study_session.number = None
    study_session.sound_tries = 0
    study_session.started_at = study_session.sound_checked_at = None
    study_session.sound_digits = ""
    study_session.rested_at_position = None
    study_session.last_active_at = now
    session.flush()
    session.expire(study_session)


def _require_unfinished(study_session: StudySession) -> None:
    if study_session.unproven_at is not None and study_session.withdrawn_at is None:
        raise ConflictError(
            "This study was continued by somebody who only knew the participant ID, so nobody "
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
    """Return the promise of the study version to which the participant consented."""
    page = tomllib.loads(study_session.version.definition).get("page", {})
    promise: Promise = page.get("withdrawn", Page.model_fields["withdrawn"].default)
    return promise


PROLIFIC_SITE: Final = "https://app.prolific.com"
PROLIFIC_END: Final = f"{PROLIFIC_SITE}/submissions/complete"

MTURK_SITES: Final = ("https://www.mturk.com", "https://workersandbox.mturk.com")
"""The only sites to which the end of an assignment may be reported."""

MTURK_FRAMES: Final = ("https://worker.mturk.com", *MTURK_SITES)
"""Sites that may show a study in a frame."""

MTURK_END: Final = "/mturk/externalSubmit"


@dataclass(frozen=True, kw_only=True)
class Exit:
    """The way out that the last page offers.

    Attributes
    ----------
    channel : Channel
        Where the participant came from.
    outcome : Outcome or None
        How the study session ended; None after a screen-out.
    code : str
        The completion code.
    address : str
        The link back, or the target of a form; may be empty.
    assignment : str
        The assignment that a form sends; empty for a link.
    """

    channel: Channel
    outcome: Outcome | None
    code: str
    address: str = ""
    assignment: str = ""


def exit_of(recruitment: Recruitment, study_session: StudySession) -> Exit | None:
    """Return the exit of a participant; None before the end is stored."""
    completion_code = study_session.completion_code
    if completion_code is None:
        return None
    has_failed_checks = study_session.outcome == "failed_attention"
    outcome: Outcome = "failed_attention" if has_failed_checks else "completed"
    # Participants from before the study went to a recruiter have no submission there.
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
                code=completion_code,
                address=study_session.submit_to + MTURK_END,
                assignment=study_session.recruiter_session,
            )
    channel: Channel = "invitations" if recruitment.channel == "invitations" else "link"
    return Exit(channel=channel, outcome=outcome, code=completion_code)


def screened_out_exit(recruitment: Recruitment) -> Exit:
    """Return the exit of somebody who was screened out; the screen-out must have been stored."""
    if recruitment.channel != "prolific":
        return Exit(channel=recruitment.channel, outcome=None, code="")
    code = recruitment.prolific.screened_out
    return Exit(channel="prolific", outcome=None, code=code, address=prolific_completion_url(code))


def return_address(recruitment: Recruitment) -> str:
    """Return the recruiter's site for participants without a code, or an empty address.

    They return their submission there.
    """
    return PROLIFIC_SITE if recruitment.channel == "prolific" else ""


def prolific_completion_url(code: str) -> str:
    """Return the address that reports `code` to Prolific."""
    return f"{PROLIFIC_END}?{urlencode({'cc': code})}"
