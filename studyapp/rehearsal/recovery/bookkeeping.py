"""Whether the study counted what happened: people, answers, codes and places."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session

from studyapp.database.tables import Place, Response, StudySession, Trial
from studyapp.monitoring.dropouts import dropouts
from studyapp.monitoring.study_sessions import Sitting
from studyapp.rehearsal.ledger import Acknowledged, AcknowledgedKey
from studyapp.rehearsal.recovery.people import Person


@dataclass(frozen=True, kw_only=True)
class Check:
    """One thing that was counted.

    Attributes
    ----------
    what : str
        In words that follow a number.
    happened, counted : int
        As the simulated participants know it, and as the study says.
    remark : str
        What a difference would mean, or where it can come from; empty where it says itself.
    allowed : bool
        Whether a difference is no fault.
    """

    what: str
    happened: int
    counted: int
    remark: str = ""
    allowed: bool = False

    @property
    def agrees(self) -> bool:
        """Whether the study counted right."""
        return self.happened == self.counted or self.allowed


def checks(
    session: Session,
    told: Acknowledged,
    everybody: Sequence[Person],
    sittings: Sequence[Sitting],
    *,
    completed_in_report: int,
) -> tuple[Check, ...]:
    """Return everything that was counted twice: by those who took part, and by the study.

    Parameters
    ----------
    told : Acknowledged
        What the participants were told.
    everybody : sequence of Person
        All who began.
    sittings : sequence of Sitting
        What the live view counts.
    completed_in_report : int
        How many the report counts as having reached the end.
    """
    return (
        *_of_people(told, everybody, sittings, completed_in_report),
        *_of_answers(told.answers, *_stored(session)),
        *_of_places(session),
    )


def _of_people(
    told: Acknowledged,
    everybody: Sequence[Person],
    sittings: Sequence[Sitting],
    completed_in_report: int,
) -> Iterator[Check]:
    stopped = Counter(person.kind for person in everybody if not person.completed)
    finished = sum(sitting.standing in ("done", "replaced") for sitting in sittings)
    codes = {person.name: person.code for person in everybody if person.completed}
    came_back = [name for name in told.returned if told.returned[name]]
    yield Check(
        what="participants began",
        happened=len({person.name for person in everybody}),
        counted=len(sittings),
        remark="one study session each",
    )
    yield Check(what="completed, says the live view", happened=len(told.codes), counted=finished)
    yield Check(
        what="completed, says the report", happened=len(told.codes), counted=completed_in_report
    )
    yield Check(
        what="left for good",
        happened=stopped["dropping_out"],
        counted=dropouts(sittings).left,
    )
    yield Check(
        what="came back after leaving and finished",
        happened=len(came_back),
        counted=sum(name in codes for name in came_back),
    )
    yield Check(
        what="were shown the code that is stored, each another one",
        happened=len(told.codes),
        counted=len({code for name, code in told.codes.items() if codes.get(name) == code}),
    )


def _of_answers(
    told: dict[AcknowledgedKey, int], stored: dict[AcknowledgedKey, list[int]], rows: int
) -> Iterator[Check]:
    as_told = sum(stored.get(key) == [value] for key, value in told.items())
    yield Check(
        what="acknowledged answers, stored once and as they were given",
        happened=len(told),
        counted=as_told,
    )
    unknown = sum(key not in told for key in stored)
    yield Check(
        what="answers stored without having been acknowledged",
        happened=0,
        counted=unknown,
        remark="the acknowledgement was lost where the rehearsal was stopped" if unknown else "",
        allowed=True,
    )
    yield Check(what="answers stored twice", happened=0, counted=rows - len(stored))


def _of_places(session: Session) -> Iterator[Check]:
    held = session.scalars(
        select(Place.study_session_id).where(Place.study_session_id.is_not(None))
    ).all()
    yield Check(
        what="places held, each by a study session of its own",
        happened=len(held),
        counted=len(set(held)),
    )


def _stored(session: Session) -> tuple[dict[AcknowledgedKey, list[int]], int]:
    """Return the stored values by what they answer, and how many rows there are."""
    query = (
        select(
            StudySession.recruiter_participant,
            Trial.position,
            Response.question,
            Response.stimulus,
            Response.value,
        )
        .join(Trial, Trial.id == Response.trial_id)
        .join(StudySession, StudySession.id == Trial.study_session_id)
    )
    found: dict[AcknowledgedKey, list[int]] = {}
    rows = 0
    for name, position, question, stimulus, value in session.execute(query):
        rows += 1
        key = (name or "", position, question, stimulus or 0)
        found.setdefault(key, []).append(value)
    return found, rows
