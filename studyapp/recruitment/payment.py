"""Who is paid: what the study knows of each participant beside what the recruiter knows.

The payment rule is the study file's, and apart from who is left out of the analysis: catch trials
never cost pay.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from sqlalchemy import select
from sqlalchemy.orm import selectinload

from studyapp.database.engine import Database, database_url_of
from studyapp.database.tables import ScreenOut, StudySession
from studyapp.session.state import state_of
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.recruitment import Prolific

Ours = Literal[
    "completed",
    "failed_attention",
    "unwatched",
    "unfinished",
    "withdrawn",
    "screened_out",
    "elsewhere",
    "nobody",
]
"""What the study knows of a submission: where its participant stands here; ``elsewhere`` where they
took part under another submission, ``nobody`` where none came under the name."""

Verdict = Literal["pay", "look", "wait", "settled"]
"""``look``: a person must decide."""

AWAITING: Final = "AWAITING REVIEW"
TIMED_OUT: Final = "TIMED-OUT"
UNDER_WAY: Final = ("ACTIVE", "RESERVED")

WHY_NOT: Final[Mapping[Ours, str]] = MappingProxyType(
    {
        "failed_attention": "failed too many attention checks",
        "unwatched": "ended early, since too many videos were said not to play",
        "unfinished": "did not finish here",
        "withdrawn": "withdrew",
        "screened_out": "was screened out",
        "elsewhere": "took part under another submission",
        "nobody": "never began here",
    }
)


@dataclass(frozen=True, kw_only=True)
class Arrived:
    """One person as the study knows them.

    Attributes
    ----------
    participant, session : str
        The recruiter's names for the person and the submission; the latter may be empty.
    code : str
        Their own completion code; empty where there is none.
    """

    participant: str
    session: str
    ours: Ours
    code: str = ""


@dataclass(frozen=True, kw_only=True)
class Judged:
    """What is to be done about one submission, and why."""

    verdict: Verdict
    why: str


def arrived(database: Database) -> list[Arrived]:
    """Return everybody whom a recruiter sent by name."""
    named = select(StudySession).where(StudySession.recruiter_participant.is_not(None))
    with database.reading() as session:
        found = [
            Arrived(
                participant=each.recruiter_participant or "",
                session=each.recruiter_session,
                ours=_ours(each),
                code=each.completion_code or "",
            )
            for each in session.scalars(
                named.order_by(StudySession.id).options(selectinload(StudySession.place))
            )
        ]
        found += [
            Arrived(participant=each.participant, session="", ours="screened_out")
            for each in session.scalars(select(ScreenOut).order_by(ScreenOut.id))
        ]
    return found


def arrived_in(folder: StudyFolder) -> list[Arrived]:
    """Return the same of a study; nobody where it has no database yet."""
    database = Database.open_for_reading(database_url_of(folder.root))
    if database is None:
        return []
    with closing(database):
        return arrived(database)


def by_submission(
    people: Sequence[Arrived], submissions: Sequence[tuple[str, str]]
) -> dict[str, Arrived]:
    """Return what the study knows of each submission: one study session is never paid twice.

    Who came without the name of a submission is taken to have come under their only one.

    Parameters
    ----------
    submissions : sequence of (str, str)
        The recruiter's names of each submission and of its participant.
    """
    known: defaultdict[str, list[Arrived]] = defaultdict(list)
    for each in people:
        known[each.participant].append(each)
    sent = Counter(participant for _, participant in submissions)
    return {
        submission: _under(submission, participant, known[participant], only=sent[participant] == 1)
        for submission, participant in submissions
    }


def _under(submission: str, participant: str, known: list[Arrived], *, only: bool) -> Arrived:
    # Who has a study session is not counted as screened out.
    own = [each for each in known if each.ours != "screened_out"] or known
    for each in own:
        if each.session == submission:
            return each
    for each in own:
        if not each.session and (only or each.ours != "completed"):
            return each
    return Arrived(
        participant=participant, session=submission, ours="elsewhere" if own else "nobody"
    )


def judge_submission(status: str, code: str | None, ours: Ours, codes: Prolific) -> Judged:
    """Return what is to be done about a submission on Prolific.

    Parameters
    ----------
    status, code : str
        As Prolific has them.
    ours : Ours
        What the study knows of the participant.
    codes : Prolific
        The study's codes.
    """
    name = status.replace("_", " ")
    if name in UNDER_WAY:
        done = "finished here, and has not told Prolific yet"
        return Judged(verdict="wait", why=done if ours == "completed" else "is under way")
    if name == TIMED_OUT and ours == "completed":
        return Judged(verdict="look", why="finished here, after Prolific's time was over")
    if name != AWAITING:
        return Judged(verdict="settled", why=name.lower())
    if ours == "completed":
        none = code is None or code in ("", "NOCODE")
        other = (
            ""
            if code == codes.completed
            else ", and entered " + ("no code" if none else "another code")
        )
        return Judged(verdict="pay", why=f"finished{other}")
    claimed = ", but entered the code of those who do" if code == codes.completed else ""
    why = WHY_NOT[ours] + (claimed if ours in ("unwatched", "unfinished", "nobody") else "")
    return Judged(verdict="look", why=why)


def judge_assignment(own_code: str, answer: str, ours: Ours) -> Judged:
    """Return what is to be done about a submitted assignment on Mechanical Turk.

    Parameters
    ----------
    own_code : str
        The participant's completion code.
    answer : str
        What was handed in with the assignment.
    ours : Ours
        What the study knows of who had the assignment.
    """
    if ours != "completed":
        return Judged(verdict="look", why=WHY_NOT[ours])
    if own_code and own_code not in answer:
        return Judged(verdict="pay", why="finished, and handed in another code")
    return Judged(verdict="pay", why="finished")


def _ours(study_session: StudySession) -> Ours:
    state = state_of(study_session)
    if state == "withdrawn":
        return "withdrawn"
    if state == "unwatched":
        return "unwatched"
    if state != "completed":
        return "unfinished"
    return "failed_attention" if study_session.outcome == "failed_attention" else "completed"
