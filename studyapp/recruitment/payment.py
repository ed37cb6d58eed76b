"""Who is paid: the study's status of each participant, beside the recruiter's.

The payment rule is in the study file, and separate from exclusion from the analysis: failed catch
trials never cost pay.
"""

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Final, Literal

from sqlalchemy import select
from sqlalchemy.orm import selectinload

from studyapp.database.engine import Database, database_url_of
from studyapp.database.tables.study_session import ScreenOut, StudySession
from studyapp.researchers.pseudonyms import fold_name
from studyapp.session.state import state_of
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.recruitment import Prolific

StudyStatus = Literal[
    "completed",
    "failed_attention",
    "unwatched",
    "unfinished",
    "withdrawn",
    "screened_out",
    "elsewhere",
    "nobody",
]
"""The status of a submission's participant in the study; ``elsewhere`` if they took part under
another submission, ``nobody`` if no participant has the name."""

Verdict = Literal["pay", "look", "wait", "settled"]
"""``look``: a researcher must decide."""

AWAITING: Final = "AWAITING REVIEW"
TIMED_OUT: Final = "TIMED-OUT"
UNDER_WAY: Final = ("ACTIVE", "RESERVED")

REASONS_NOT_TO_PAY: Final[Mapping[StudyStatus, str]] = {
    "failed_attention": "failed too many attention checks",
    "unwatched": "ended early, since too many videos were said not to play",
    "unfinished": "did not finish here",
    "withdrawn": "withdrew",
    "screened_out": "was screened out",
    "elsewhere": "took part under another submission",
    "nobody": "never began here",
}


@dataclass(frozen=True, kw_only=True)
class KnownParticipant:
    """A participant as the study knows them.

    Attributes
    ----------
    participant, session : str
        The recruiter's names for the participant and the submission; the latter may be empty.
    code : str
        Their own completion code; empty if they have none.
    """

    participant: str
    session: str
    study_status: StudyStatus
    code: str = ""


@dataclass(frozen=True, kw_only=True)
class PaymentDecision:
    """What to do about one submission, and why."""

    verdict: Verdict
    reason: str


def known_participants(database: Database) -> list[KnownParticipant]:
    """Return everybody whom a recruiter sent by name."""
    named = select(StudySession).where(StudySession.recruiter_participant.is_not(None))
    with database.reading() as session:
        participants = [
            KnownParticipant(
                participant=each.recruiter_participant or "",
                session=each.recruiter_session,
                study_status=_status_of(each),
                code=each.completion_code or "",
            )
            for each in session.scalars(
                named.order_by(StudySession.id).options(selectinload(StudySession.place))
            )
        ]
        participants += [
            KnownParticipant(participant=each.participant, session="", study_status="screened_out")
            for each in session.scalars(select(ScreenOut).order_by(ScreenOut.id))
        ]
    return participants


def known_participants_of(folder: StudyFolder, *, has_submissions: bool) -> list[KnownParticipant]:
    """Return the same of a study; nobody before the first serving, when it has no database.

    Raises
    ------
    InputError
        If there is no database although the recruiter has submissions: nobody would seem to have
        taken part.
    """
    url = database_url_of(folder.root)
    database = Database.open_existing(url) if has_submissions else Database.open_for_reading(url)
    if database is None:
        return []
    with closing(database):
        return known_participants(database)


def by_submission(
    people: Sequence[KnownParticipant], submissions: Sequence[tuple[str, str]]
) -> dict[str, KnownParticipant]:
    """Return the participant of each submission, so that no study session is paid twice.

    Participants who came without the name of a submission are matched to their only one.

    Parameters
    ----------
    submissions : sequence of (str, str)
        The recruiter's names of each submission and of its participant.
    """
    by_name: defaultdict[str, list[KnownParticipant]] = defaultdict(list)
    for person in people:
        by_name[fold_name(person.participant)].append(person)
    counts = Counter(fold_name(participant) for _, participant in submissions)
    return {
        submission: _match(submission, participant, by_name[name], counts[name] == 1)
        for submission, participant in submissions
        for name in [fold_name(participant)]
    }


def _match(
    submission: str, participant: str, people: list[KnownParticipant], is_only: bool
) -> KnownParticipant:
    # A participant with a study session does not count as screened out.
    people = [each for each in people if each.study_status != "screened_out"] or people
    for person in people:
        if person.session == submission:
            return person
    for person in people:
        if not person.session and (is_only or person.study_status != "completed"):
            return person
    status: StudyStatus = "elsewhere" if people else "nobody"
    return KnownParticipant(participant=participant, session=submission, study_status=status)


def judge_submission(
    status: str, code: str | None, study_status: StudyStatus, codes: Prolific
) -> PaymentDecision:
    """Return what to do about a submission on Prolific.

    Parameters
    ----------
    status, code : str
        Prolific's status and code.
    study_status : StudyStatus
        The participant's status in the study.
    codes : Prolific
        The study's codes.
    """
    name = status.replace("_", " ")
    has_finished = study_status == "completed"
    if name in UNDER_WAY:
        unreported = "finished here, and has not told Prolific yet"
        reason = unreported if has_finished else "is under way"
        return PaymentDecision(verdict="wait", reason=reason)
    if name == TIMED_OUT and has_finished:
        reason = "finished here, after Prolific's time was over"
        return PaymentDecision(verdict="look", reason=reason)
    if name != AWAITING:
        return PaymentDecision(verdict="settled", reason=name.lower())
    if has_finished:
        entered = "no code" if code in (None, "", "NOCODE") else "another code"
        other = "" if code == codes.completed else f", and entered {entered}"
        return PaymentDecision(verdict="pay", reason=f"finished{other}")
    reason = REASONS_NOT_TO_PAY[study_status]
    if code == codes.completed and study_status != "elsewhere":
        reason += ", but entered the code for finishing"
    return PaymentDecision(verdict="look", reason=reason)


def judge_assignment(own_code: str, answer: str, study_status: StudyStatus) -> PaymentDecision:
    """Return what to do about a submitted assignment on Mechanical Turk.

    Parameters
    ----------
    own_code : str
        The participant's completion code.
    answer : str
        The answer submitted with the assignment.
    study_status : StudyStatus
        The worker's status in the study.
    """
    if study_status != "completed":
        return PaymentDecision(verdict="look", reason=REASONS_NOT_TO_PAY[study_status])
    if own_code and own_code not in answer:
        return PaymentDecision(verdict="pay", reason="finished, and handed in another code")
    return PaymentDecision(verdict="pay", reason="finished")


def _status_of(study_session: StudySession) -> StudyStatus:
    state = state_of(study_session)
    if state == "completed":
        return "failed_attention" if study_session.outcome == "failed_attention" else "completed"
    return state if state in ("withdrawn", "unwatched") else "unfinished"
