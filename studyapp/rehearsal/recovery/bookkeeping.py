"""Whether the study counted what happened: people, answers, codes and places."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session

from studyapp.database.tables import Place, Response, Trial
from studyapp.monitoring.counts import dropouts
from studyapp.monitoring.study_sessions import SessionProgress
from studyapp.rehearsal.ledger import Acknowledged, AnswerPlace
from studyapp.rehearsal.people import Person


@dataclass(frozen=True)
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
        Whether a difference is not a fault.
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
    study_sessions: Sequence[SessionProgress],
    *,
    completed_in_report: int,
) -> Iterator[Check]:
    """Yield everything that was counted twice: by those who took part, and by the study.

    Parameters
    ----------
    told : Acknowledged
        What the participants were told.
    everybody : sequence of Person
        All who began.
    study_sessions : sequence of SessionProgress
        What the live view counts.
    completed_in_report : int
        How many the report counts as having reached the end.
    """
    codes = {person.name: person.code for person in everybody if person.completed}
    came_back = [name for name, times in told.returned.items() if times]
    places = select(Place.study_session_id).where(Place.study_session_id.is_not(None))
    held = session.scalars(places).all()
    ended = sum(study_session.standing in ("done", "replaced") for study_session in study_sessions)
    gone = sum(who.rater.kind == "dropping_out" for who in everybody if not who.completed)
    right_codes = {code for name, code in told.codes.items() if codes.get(name) == code}
    names = {person.name for person in everybody}
    back_and_done = sum(name in codes for name in came_back)
    yield Check("participants began", len(names), len(study_sessions), "one study session each")
    yield Check("completed, says the live view", len(told.codes), ended)
    yield Check("completed, says the report", len(told.codes), completed_in_report)
    yield Check("left for good", gone, dropouts(study_sessions).left)
    yield Check("came back after leaving and finished", len(came_back), back_and_done)
    yield Check(
        "were shown the code that is stored, each another one", len(told.codes), len(right_codes)
    )
    yield Check("places held, each by a study session of its own", len(held), len(set(held)))
    yield from answer_checks(session, told.answers)


def answer_checks(session: Session, told: Mapping[AnswerPlace, int]) -> Iterator[Check]:
    """Yield whether the answers that participants were `told` of are stored once, as given."""
    query = select(Trial.token, Response.question, Response.stimulus, Response.value)
    stored: dict[AnswerPlace, list[int]] = {}
    for trial, question, stimulus, value in session.execute(query.join(Response.trial)):
        stored.setdefault((trial, question, stimulus or 0), []).append(value)
    kept = sum(stored.get(place) == [value] for place, value in told.items())
    yield Check("acknowledged answers, stored once and as they were given", len(told), kept)
    unknown = len(stored.keys() - told.keys())
    yield Check(
        "answers stored without having been acknowledged",
        0,
        unknown,
        remark="the acknowledgement was lost where the rehearsal was stopped" if unknown else "",
        allowed=True,
    )
    twice = sum(len(values) - 1 for values in stored.values())
    yield Check("answers stored twice", 0, twice)
