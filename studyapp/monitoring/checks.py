"""Catch trials and attention checks: who failed them, and which of them good raters fail."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sqlalchemy import or_, select
from sqlalchemy.orm import Session

from studyapp.database.tables import Response, Trial, TrialStimulus
from studyapp.session.exclusion import JUDGED, JudgedTrial
from studyapp.study.settings.study import Study


class Check(NamedTuple):
    """One catch trial or attention check that somebody is done with.

    Attributes
    ----------
    item : str
        What it is: its segment and, of a catch trial, the conditions shown.
    failed : bool
        To leave one out is to fail it.
    answered : bool
        Whether it was answered, not left out.
    """

    study_session: int
    kind: str
    item: str
    failed: bool
    answered: bool = True


@dataclass(frozen=True, kw_only=True)
class CheckedItem:
    """One catch trial or attention check that several participants were given.

    Attributes
    ----------
    answered, failed : int
    careful, careful_failed : int
        The same, of participants who failed none of their other checks.
    """

    kind: str
    item: str
    answered: int
    failed: int
    careful: int
    careful_failed: int


def checks(session: Session, study: Study, wanted: Collection[int]) -> list[Check]:
    """Judge every check that was answered, or left out, in the study sessions `wanted`."""
    settled = or_(Trial.answered_at.is_not(None), Trial.unplayable_at.is_not(None))
    query = select(
        Trial.id,
        Trial.study_session_id,
        Trial.kind,
        Trial.part,
        Trial.segment,
        Trial.expected,
        Trial.instructed,
        Trial.answered_at.is_not(None),
    )
    rows = session.connection().execute(
        query.where(Trial.kind.in_(JUDGED), settled).order_by(Trial.id)
    )
    shown = _conditions(session)
    answers = _answers(session)
    found = []
    for trial_id, study_session, kind, part, segment, expected, instructed, answered in rows:
        if study_session not in wanted:
            continue
        conditions = shown.get(trial_id, ())
        judged = JudgedTrial(kind, part, conditions, expected, instructed)
        pair = f": {' and '.join(sorted(conditions))}" if kind == "catch" else ""
        failed = not answered or study.failed(judged, answers.get(trial_id, {}))
        found.append(Check(study_session, kind, f"{segment}{pair}", failed, answered))
    return found


def checked_items(found: Iterable[Check]) -> tuple[CheckedItem, ...]:
    """Return how each check was answered, those failed most often first.

    That one was left out says nothing of it; it does of the participant.
    """
    found = list(found)
    failures: dict[int, int] = defaultdict(int)
    for check in found:
        failures[check.study_session] += check.failed
    by_item: dict[tuple[str, str], list[Check]] = defaultdict(list)
    for check in found:
        if check.answered:
            by_item[check.kind, check.item].append(check)
    items = [
        _item(kind, item, of_item, failures) for (kind, item), of_item in sorted(by_item.items())
    ]
    return tuple(sorted(items, key=lambda each: -each.failed / each.answered))


def failed_by_session(found: Iterable[Check], kind: str) -> dict[int, int]:
    """Return how many checks of `kind` each study session failed, of those that had any."""
    failures: dict[int, int] = {}
    for check in found:
        if check.kind == kind:
            failures[check.study_session] = failures.get(check.study_session, 0) + check.failed
    return failures


def _item(kind: str, item: str, of_item: Sequence[Check], failures: dict[int, int]) -> CheckedItem:
    careful = [each for each in of_item if failures[each.study_session] - each.failed == 0]
    return CheckedItem(
        kind=kind,
        item=item,
        answered=len(of_item),
        failed=sum(each.failed for each in of_item),
        careful=len(careful),
        careful_failed=sum(each.failed for each in careful),
    )


def _conditions(session: Session) -> dict[int, tuple[str, ...]]:
    """Return the conditions that each check shows, number 1 first."""
    query = select(TrialStimulus.trial_id, TrialStimulus.condition).join(TrialStimulus.trial)
    query = query.where(Trial.kind.in_(JUDGED), TrialStimulus.number > 0)
    found: dict[int, tuple[str, ...]] = defaultdict(tuple)
    for trial, condition in session.connection().execute(query.order_by(TrialStimulus.number)):
        found[trial] += (condition,)
    return found


def _answers(session: Session) -> dict[int, dict[tuple[str, int | None], int]]:
    query = select(Response.trial_id, Response.question, Response.stimulus, Response.value)
    query = query.join(Response.trial).where(Trial.kind.in_(JUDGED))
    found: dict[int, dict[tuple[str, int | None], int]] = defaultdict(dict)
    for trial, question, stimulus, value in session.connection().execute(query):
        found[trial][question, stimulus] = value
    return found
