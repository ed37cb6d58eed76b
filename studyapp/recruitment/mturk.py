"""A study on Mechanical Turk: making HITs, watching and paying."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any, Final
from xml.sax.saxutils import escape

from motion.errors import InputError
from studyapp.recruitment.mturk_client import Assignment, Hit, MTurkClient
from studyapp.recruitment.payment import (
    Arrived,
    Judged,
    arrived_in,
    by_submission,
    judge_assignment,
)
from studyapp.recruitment.prolific_draft import places_of, require_public
from studyapp.recruitment.record import MadeThere, read_made_there, write_made_there
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

SCHEMA: Final = (
    "http://mechanicalturk.amazonaws.com/AWSMechanicalTurkDataSchemas/2006-07-14/"
    "ExternalQuestion.xsd"
)
TIMES_AS_LONG: Final = 4
"""So many times what the study takes may pass before an assignment is taken away."""

SECONDS_PER_MINUTE: Final = 60
SECONDS_PER_HOUR: Final = 3600
SECONDS_PER_DAY: Final = 86_400


def hit_request(study: Study, address: str, *, made_before: int, live: bool) -> dict[str, Any]:
    """Return the HIT of `study`, which workers see in a frame that shows `address`.

    Parameters
    ----------
    made_before : int
        How many HITs the study has; the same number asks for the same HIT.
    live : bool
        Whether it is not for the sandbox.

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
        "Keywords": recruited.keywords,
        "Reward": recruited.reward,
        "MaxAssignments": recruited.assignments or places_of(study),
        "LifetimeInSeconds": recruited.hours_to_accept * SECONDS_PER_HOUR,
        "AssignmentDurationInSeconds": minutes * SECONDS_PER_MINUTE * TIMES_AS_LONG,
        "AutoApprovalDelayInSeconds": recruited.days_to_review * SECONDS_PER_DAY,
        "Question": f'<ExternalQuestion xmlns="{SCHEMA}"><ExternalURL>{escape(address)}'
        "</ExternalURL><FrameHeight>0</FrameHeight></ExternalQuestion>",
        "UniqueRequestToken": hashlib.sha256(once.encode()).hexdigest(),
    }


SUBMITTED = "Submitted"


@dataclass(frozen=True, kw_only=True)
class JudgedAssignment:
    """One assignment, and what is to be done about it."""

    assignment: Assignment
    judged: Judged


def request_of(folder: StudyFolder, address: str, *, live: bool) -> dict[str, Any]:
    """Return what `create` sends."""
    made = read_made_there(folder.root)
    return hit_request(
        folder.study(), address, made_before=len(_hits_in(made, live=live)), live=live
    )


def create(folder: StudyFolder, client: MTurkClient, address: str, *, live: bool) -> Hit:
    """Make one more HIT for the study."""
    hit = client.create(request_of(folder, address, live=live))
    made = read_made_there(folder.root)
    key = "live_hits" if live else "sandbox_hits"
    if hit.id not in _hits_in(made, live=live):
        hits = (*_hits_in(made, live=live), hit.id)
        write_made_there(folder.root, made.model_copy(update={key: hits}))
    return hit


def hits_of(folder: StudyFolder, *, live: bool) -> tuple[str, ...]:
    """Return the ids of the study's HITs.

    Raises
    ------
    InputError
        If none was made.
    """
    hits = _hits_in(read_made_there(folder.root), live=live)
    if not hits:
        raise InputError(
            f"the study has no HIT on {'the live site' if live else 'the sandbox'}",
            where=folder.root,
            remedy="Make one with 'motionjury recruit STUDY create'"
            + ("" if live else ", or look at the live site with --live"),
        )
    return hits


def judged(folder: StudyFolder, client: MTurkClient, *, live: bool) -> list[JudgedAssignment]:
    """Return every assignment that was handed in, and what is to be done about it."""
    people = arrived_in(folder)
    assignments = [each for hit in hits_of(folder, live=live) for each in client.assignments(hit)]
    known = by_submission(people, [(each.id, each.worker) for each in assignments])
    return [
        JudgedAssignment(assignment=each, judged=_judged(each, known[each.id]))
        for each in assignments
    ]


def approve(client: MTurkClient, found: list[JudgedAssignment]) -> int:
    """Pay every assignment that the payment rule pays; return how many."""
    paid = [each.assignment.id for each in found if each.judged.verdict == "pay"]
    for assignment in paid:
        client.approve(assignment)
    return len(paid)


def _hits_in(made: MadeThere, *, live: bool) -> tuple[str, ...]:
    return made.live_hits if live else made.sandbox_hits


def _judged(assignment: Assignment, known: Arrived) -> Judged:
    if assignment.status != SUBMITTED:
        return Judged(verdict="settled", why=assignment.status.lower())
    return judge_assignment(known.code, assignment.answer, known.ours)
