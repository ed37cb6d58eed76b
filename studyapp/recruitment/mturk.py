"""A study on Mechanical Turk: making HITs, watching and paying.

The sandbox is the default. boto3 finds the keys in the environment or in its own files; they never
pass through here.
"""

import hashlib
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from datetime import UTC, datetime
from typing import Any, Final
from xml.sax.saxutils import escape

from pydantic import BaseModel, ConfigDict, Field

from motion.errors import InputError
from studyapp.boto_errors import as_input_errors
from studyapp.recruitment.payment import (
    KnownParticipant,
    PaymentDecision,
    by_submission,
    judge_assignment,
    known_participants_of,
)
from studyapp.recruitment.record import (
    RecruitmentRecord,
    count_places,
    read_record,
    require_public,
    write_record,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

SANDBOX: Final = "https://mturk-requester-sandbox.us-east-1.amazonaws.com"
LIVE: Final = "https://mturk-requester.us-east-1.amazonaws.com"
REGION: Final = "us-east-1"
PAGE_SIZE: Final = 100
LONG_AGO: Final = datetime(2015, 1, 1, tzinfo=UTC)


class Hit(BaseModel):
    """A HIT and how far it is.

    Attributes
    ----------
    wanted, pending, available, completed : int
        Assignments in all, in progress, not yet taken, and reviewed.
    """

    model_config = ConfigDict(extra="ignore", frozen=True)
    id: str = Field(validation_alias="HITId")
    status: str = Field("", validation_alias="HITStatus")
    wanted: int = Field(0, validation_alias="MaxAssignments")
    pending: int = Field(0, validation_alias="NumberOfAssignmentsPending")
    available: int = Field(0, validation_alias="NumberOfAssignmentsAvailable")
    completed: int = Field(0, validation_alias="NumberOfAssignmentsCompleted")


class Assignment(BaseModel):
    """A worker's submission."""

    model_config = ConfigDict(extra="ignore", frozen=True)
    id: str = Field(validation_alias="AssignmentId")
    worker: str = Field(validation_alias="WorkerId")
    status: str = Field(validation_alias="AssignmentStatus")
    answer: str = Field("", validation_alias="Answer")


class MTurkClient:
    """A requester's access to Mechanical Turk.

    Parameters
    ----------
    connection : object
        boto3's client; see `connect`.
    """

    def __init__(self, connection: Any) -> None:
        self._connection = connection

    def create(self, request: Mapping[str, Any]) -> Hit:
        """Make a HIT, visible at once; the same request within a day makes no second one."""
        with _as_input_errors("create a HIT"):
            return Hit.model_validate(self._connection.create_hit(**request)["HIT"])

    def hit(self, hit: str) -> Hit:
        """Return the HIT with this id."""
        with _as_input_errors(f"look at HIT {hit}"):
            return Hit.model_validate(self._connection.get_hit(HITId=hit)["HIT"])

    def stop(self, hit: str) -> None:
        """Offer a HIT to nobody else; workers who have begun may finish."""
        with _as_input_errors(f"stop HIT {hit}"):
            self._connection.update_expiration_for_hit(HITId=hit, ExpireAt=LONG_AGO)

    def assignments(self, hit: str) -> list[Assignment]:
        """Return all submissions for a HIT."""
        with _as_input_errors(f"list the assignments of HIT {hit}"):
            pages = self._connection.get_paginator("list_assignments_for_hit")
            return [
                Assignment.model_validate(assignment)
                for page in pages.paginate(HITId=hit, PaginationConfig={"PageSize": PAGE_SIZE})
                for assignment in page["Assignments"]
            ]

    def approve(self, assignment: str) -> None:
        """Pay for an assignment."""
        with _as_input_errors(f"approve assignment {assignment}"):
            self._connection.approve_assignment(AssignmentId=assignment)


def connect(*, live: bool) -> MTurkClient:
    """Return access to Mechanical Turk, or to its sandbox.

    Raises
    ------
    InputError
        If boto3 is not installed.
    """
    try:
        import boto3
    except ImportError:
        raise InputError(
            "Mechanical Turk needs boto3, which is not installed",
            remedy="Install it with 'pip install motionjury[mturk]'",
        ) from None
    endpoint = LIVE if live else SANDBOX
    return MTurkClient(boto3.client("mturk", region_name=REGION, endpoint_url=endpoint))


def _as_input_errors(what: str) -> AbstractContextManager[None]:
    return as_input_errors(
        "Mechanical Turk",
        what,
        correct="Correct what it names; requesters of the sandbox and of the live site are "
        "different accounts",
        check="the network",
    )


SCHEMA: Final = (
    "http://mechanicalturk.amazonaws.com/AWSMechanicalTurkDataSchemas/2006-07-14/"
    "ExternalQuestion.xsd"
)
TIMES_AS_LONG: Final = 4
"""A worker may take so many times the study's duration before the assignment is withdrawn."""


def hit_request(study: Study, address: str, *, made_before: int, live: bool) -> dict[str, Any]:
    """Return the HIT of `study`, which workers see in a frame that shows `address`.

    Parameters
    ----------
    made_before : int
        How many HITs the study has; the same number requests the same HIT.
    live : bool
        Whether it is for the live site rather than the sandbox.

    Raises
    ------
    InputError
        If the study file does not say what Mechanical Turk needs, or nobody could open the
        address.
    """
    recruited = study.recruitment.mturk
    minutes = study.page.minutes
    if not recruited.dollars or minutes is None:
        raise InputError(
            "Mechanical Turk needs recruitment.mturk.reward and page.minutes",
            where="study.toml",
            remedy='Fill them in; a reward is written like "3.50"',
        )
    require_public(address)
    once = f"{study.name} {address} {made_before} {live}"
    return {
        "Title": study.title[:128],
        "Description": recruited.description or study.title,
        "Keywords": "video, animation, opinion",
        "Reward": f"{recruited.dollars:.2f}",
        "MaxAssignments": count_places(study),
        "LifetimeInSeconds": 72 * 3600,
        "AssignmentDurationInSeconds": minutes * 60 * TIMES_AS_LONG,
        "AutoApprovalDelayInSeconds": 7 * 86_400,
        "Question": f'<ExternalQuestion xmlns="{SCHEMA}"><ExternalURL>{escape(address)}'
        "</ExternalURL><FrameHeight>0</FrameHeight></ExternalQuestion>",
        "UniqueRequestToken": hashlib.sha256(once.encode()).hexdigest(),
    }


def request_of(folder: StudyFolder, address: str, *, live: bool) -> dict[str, Any]:
    """Return what `create` sends."""
    record = read_record(folder.root)
    return hit_request(
        folder.study(), address, made_before=len(_hits_in(record, live=live)), live=live
    )


def create(folder: StudyFolder, client: MTurkClient, address: str, *, live: bool) -> Hit:
    """Make one more HIT for the study."""
    hit = client.create(request_of(folder, address, live=live))
    record = read_record(folder.root)
    key = "live_hits" if live else "sandbox_hits"
    if hit.id not in _hits_in(record, live=live):
        hits = (*_hits_in(record, live=live), hit.id)
        write_record(folder.root, record.model_copy(update={key: hits}))
    return hit


def hits_of(folder: StudyFolder, *, live: bool) -> tuple[str, ...]:
    """Return the ids of the study's HITs.

    Raises
    ------
    InputError
        If none was made.
    """
    hits = _hits_in(read_record(folder.root), live=live)
    if not hits:
        raise InputError(
            f"the study has no HIT on {'the live site' if live else 'the sandbox'}",
            where=folder.root,
            remedy="Make one with 'motionjury recruit STUDY create'"
            + ("" if live else ", or look at the live site with --live"),
        )
    return hits


def judged_assignments(
    folder: StudyFolder, client: MTurkClient, *, live: bool
) -> list[tuple[Assignment, PaymentDecision]]:
    """Return every submitted assignment, and what to do about it."""
    assignments = [each for hit in hits_of(folder, live=live) for each in client.assignments(hit)]
    people = known_participants_of(folder, has_submissions=bool(assignments))
    participants = by_submission(people, [(each.id, each.worker) for each in assignments])
    return [(each, _decide(each, participants[each.id])) for each in assignments]


def approve(client: MTurkClient, judged: Sequence[tuple[Assignment, PaymentDecision]]) -> int:
    """Pay every assignment that the payment rule pays; return how many."""
    paid = [assignment.id for assignment, decision in judged if decision.verdict == "pay"]
    for assignment in paid:
        client.approve(assignment)
    return len(paid)


def _hits_in(record: RecruitmentRecord, *, live: bool) -> tuple[str, ...]:
    return record.live_hits if live else record.sandbox_hits


def _decide(assignment: Assignment, participant: KnownParticipant) -> PaymentDecision:
    if assignment.status != "Submitted":
        return PaymentDecision(verdict="settled", reason=assignment.status.lower())
    return judge_assignment(participant.code, assignment.answer, participant.study_status)
