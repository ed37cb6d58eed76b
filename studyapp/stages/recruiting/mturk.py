"""A study on Mechanical Turk: making HITs, watching and paying."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from motion.errors import InputError
from studyapp.definition.folder import StudyFolder
from studyapp.services.database import Database, database_url_of
from studyapp.services.recruiting.made_there import MadeThere, read_made_there, write_made_there
from studyapp.services.recruiting.mturk_client import Assignment, Hit, MTurkClient
from studyapp.services.recruiting.mturk_hit import hit_request
from studyapp.services.recruiting.payment import (
    Arrived,
    Judged,
    arrived,
    by_submission,
    judge_assignment,
)

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
    database = Database.open_for_reading(database_url_of(folder.root))
    people: list[Arrived] = []
    if database is not None:
        try:
            people = arrived(database)
        finally:
            database.close()
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
