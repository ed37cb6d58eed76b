"""A study on Prolific: its draft, watching and paying."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from motion.errors import InputError
from motion.segment import Segment
from studyapp.recruitment.payment import (
    PaymentDecision,
    StudyStatus,
    by_submission,
    judge_submission,
    known_participants_of,
)
from studyapp.recruitment.record import count_places, read_record, require_public, write_record
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.presentation import Device
from studyapp.study.settings.study import Study

if TYPE_CHECKING:
    from studyapp.recruitment.prolific_client import ProlificClient, ProlificStudy, Submission

CODE_TYPES: Final = {
    "completed": "COMPLETED",
    "screened_out": "OTHER",
    "failed_attention": "FAILED_ATTENTION_CHECK",
}
"""Prolific's types of the study's codes."""

DEVICES: Final[Mapping[Device, str]] = {
    "computer": "desktop",
    "tablet": "tablet",
    "phone": "mobile",
}
"""Prolific's names of the kinds of devices."""

RETURN_REASON: Final = "The study looks for other participants."

CENTS: Final = 100


def internal_name(study: Study) -> str:
    """Return the name by which the study is found again among the researcher's studies.

    Two studies may have the same name, but not the same code.
    """
    drawn = hashlib.sha256(study.recruitment.prolific.completed.encode()).hexdigest()
    return f"motionjury {study.name} {drawn[:8]}"


def prolific_draft(study: Study, segments: Sequence[Segment], address: str) -> dict[str, Any]:
    """Return the draft of `study`, which participants reach at `address`.

    Raises
    ------
    InputError
        If the study file does not say what Prolific needs, or nobody could open the address.
    """
    missing = [
        *(f"recruitment.prolific.{key}" for key in study.recruitment.missing_codes),
        *([] if study.recruitment.prolific.reward else ["recruitment.prolific.reward"]),
        *([] if study.page.minutes else ["page.minutes"]),
    ]
    if missing:
        raise InputError(
            f"Prolific needs {', '.join(missing)}",
            where="study.toml",
            remedy="Fill them in; 'motionjury recruit STUDY codes' draws the codes",
        )
    require_public(address)
    recruited = study.recruitment.prolific
    screened_out: dict[str, Any] = {"action": "REQUEST_RETURN", "return_reason": RETURN_REASON}
    review = {"action": "MANUALLY_REVIEW"}
    finished = {"action": "AUTOMATICALLY_APPROVE"} if recruited.automatic else review
    heard = any(
        shown.speech is not None for content in study.contents(segments) for shown in content
    )
    draft: dict[str, Any] = {
        "name": study.title,
        "internal_name": internal_name(study),
        "description": recruited.description or study.title,
        "external_study_url": study.recruitment.link(address),
        "prolific_id_option": "url_parameters",
        "completion_codes": [
            _code(CODE_TYPES["completed"], recruited.completed, finished),
            _code(CODE_TYPES["screened_out"], recruited.screened_out, screened_out),
            _code(CODE_TYPES["failed_attention"], recruited.failed_attention, review),
        ],
        "total_available_places": count_places(study),
        "estimated_completion_time": study.page.minutes,
        "reward": recruited.reward,
        "device_compatibility": [DEVICES[device] for device in study.page.devices],
        "peripheral_requirements": ["audio"] if heard else [],
        "filters": [],
    }
    if recruited.signed_for:
        draft["is_external_study_url_secure"] = True
    return draft


def _code(kind: str, code: str, action: dict[str, Any]) -> dict[str, Any]:
    return {"code": code, "code_type": kind, "actor": "participant", "actions": [action]}


@dataclass(frozen=True, kw_only=True)
class JudgedSubmission:
    """A submission, its participant's status in the study, and what to do about it."""

    submission: Submission
    study_status: StudyStatus
    decision: PaymentDecision


@dataclass(frozen=True, kw_only=True)
class ProlificStatus:
    """The status of a study on Prolific.

    Attributes
    ----------
    status_counts : mapping
        How many submissions have each status on Prolific and in the study.
    """

    study: ProlificStudy
    submissions: tuple[JudgedSubmission, ...]
    status_counts: dict[tuple[str, StudyStatus], int]


def draft_of(folder: StudyFolder, address: str) -> dict[str, Any]:
    """Return what `create` sends."""
    study = folder.study()
    return prolific_draft(study, folder.segments_of(study), address)


def create(folder: StudyFolder, client: ProlificClient, address: str) -> tuple[ProlificStudy, bool]:
    """Make the draft on Prolific, unless there is one.

    Returns
    -------
    study : ProlificStudy
    made : bool
        Whether it was not there before.
    """
    draft = draft_of(folder, address)
    record = read_record(folder.root)
    identity = record.prolific_study
    if identity is None:
        # An earlier attempt may have succeeded although its response was lost.
        existing = client.study_named(internal_name(folder.study()))
        identity = None if existing is None else existing.id
    study = client.create(draft) if identity is None else client.study(identity)
    codes = {each.code: each.code_type for each in study.completion_codes}
    update = {"prolific_study": study.id, "prolific_codes": codes or record.prolific_codes}
    write_record(folder.root, record.model_copy(update=update))
    return study, identity is None


def study_id(folder: StudyFolder) -> str:
    """Return Prolific's id of the study.

    Raises
    ------
    InputError
        If none was made.
    """
    prolific_id = read_record(folder.root).prolific_study
    if prolific_id is None:
        raise InputError(
            "the study is not on Prolific yet",
            where=folder.root,
            remedy="Make a draft with 'motionjury recruit STUDY create'",
        )
    return prolific_id


def status(folder: StudyFolder, client: ProlificClient) -> ProlificStatus:
    """Return the status of the study, on Prolific and here."""
    identity = study_id(folder)
    codes = folder.study().recruitment.prolific
    submissions = client.submissions(identity)
    people = known_participants_of(folder, has_submissions=bool(submissions))
    participants = by_submission(people, [(each.id, each.participant) for each in submissions])
    judged_submissions = tuple(
        JudgedSubmission(
            submission=each,
            study_status=study_status,
            decision=judge_submission(each.status, each.code, study_status, codes),
        )
        for each in submissions
        for study_status in [participants[each.id].study_status]
    )
    statuses = Counter((each.submission.status, each.study_status) for each in judged_submissions)
    return ProlificStatus(
        study=client.study(identity),
        submissions=judged_submissions,
        status_counts=dict(statuses),
    )


def approve(client: ProlificClient, status: ProlificStatus) -> int:
    """Pay everybody whom the payment rule pays; return how many."""
    paid = [each.submission.id for each in status.submissions if each.decision.verdict == "pay"]
    client.approve(paid)
    return len(paid)
