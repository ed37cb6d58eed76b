"""What simulated participants experienced, compared with what the database stored."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session, selectinload

from studyapp.database.tables.study_session import Place, StudySession
from studyapp.database.tables.trial import Response, Trial
from studyapp.monitoring.study_sessions import SessionProgress
from studyapp.rehearsal.eyes import rater_name
from studyapp.rehearsal.simulation.raters import Rater
from studyapp.rehearsal.simulation.truth import Truth
from studyapp.study.design.trial import Answers

AnswerPlace = tuple[str, str, int]
"""Token of the trial, question, and number of the stimulus (0 for the trial)."""


@dataclass(frozen=True, kw_only=True)
class Acknowledged:
    """Everything that was acknowledged to participants.

    Attributes
    ----------
    answers : dict of AnswerPlace to int
        Values.
    codes : dict of str to str
        The completion code of each participant who has one.
    left, returned : set of str
        Who left temporarily, and came back.
    """

    answers: dict[AnswerPlace, int] = field(default_factory=dict)
    codes: dict[str, str] = field(default_factory=dict)
    left: set[str] = field(default_factory=set)
    returned: set[str] = field(default_factory=set)


@dataclass(frozen=True)
class Ledger:
    """A file with a line for each acknowledgement, written as soon as it was received.

    It survives a rehearsal that is stopped at any time, and contains only what participants were
    told.
    """

    path: Path
    lock: Lock = field(default_factory=Lock, repr=False)

    def answered(self, name: str, trial: str, values: Answers) -> None:
        """Record that the answers to the trial with the token `trial` were accepted."""
        answers = [[question, stimulus or 0, v] for (question, stimulus), v in values.items()]
        self.note(name, trial=trial, answers=answers)

    def note(self, name: str, **what: Any) -> None:
        """Record the ``code`` that a participant was shown, or that it ``left`` or ``returned``."""
        line = json.dumps({"participant": name} | what)
        with self.lock:
            self.path.parent.mkdir(exist_ok=True)
            with self.path.open("ab") as file:
                # An unfinished line of a killed run stays a line of its own.
                file.write(b"\n" + line.encode() + b"\n")

    def read(self) -> Acknowledged:
        """Return everything that was recorded."""
        acknowledged = Acknowledged()
        for line in self._lines():
            name = line["participant"]
            for question, stimulus, value in line.get("answers", ()):
                acknowledged.answers[line["trial"], question, stimulus] = value
            if "code" in line:
                acknowledged.codes[name] = line["code"]
            if "left" in line:
                acknowledged.left.add(name)
            if "returned" in line:
                acknowledged.returned.add(name)
        return acknowledged

    def _lines(self) -> Iterator[dict[str, Any]]:
        """Yield all complete lines."""
        if not self.path.exists():
            return
        for text in self.path.read_text("utf-8", errors="replace").splitlines():
            try:
                line = json.loads(text)
            except json.JSONDecodeError:
                continue
            if isinstance(line, dict) and "participant" in line:
                yield line


@dataclass(frozen=True, kw_only=True)
class Person:
    """A simulated participant.

    Attributes
    ----------
    study_session : str
        The number of its study session.
    name : str
        Its id at the recruiter.
    rater : Rater
        The rater that answers.
    completed, has_place : bool
        Whether it has a completion code, and a place.
    code : str
        The stored completion code; may be empty.
    trials, settled : int
        The number of its trials, and of the finished ones.
    """

    study_session: str
    name: str
    rater: Rater
    completed: bool
    has_place: bool = True
    code: str = ""
    trials: int = 1
    settled: int = 0

    @property
    def has_left(self) -> bool:
        """Whether it has dropped out, which happens at a certain trial."""
        leaves_at = None if self.rater.returns else self.rater.leaves_at(self.trials)
        return not self.completed and leaves_at is not None and self.settled >= leaves_at - 1


def people(session: Session, truth: Truth) -> tuple[Person, ...]:
    """Return all participants in the order of their arrival."""
    study_sessions = session.scalars(
        select(StudySession)
        .order_by(StudySession.id)
        .options(selectinload(StudySession.place), selectinload(StudySession.trials))
    )
    return tuple(
        Person(
            study_session=str(row.id),
            name=row.recruiter_participant or "",
            rater=Rater(
                population=truth.population, seed=truth.seed, name=rater_name(session, row)
            ),
            completed=row.completed_at is not None,
            has_place=row.place is not None,
            code=row.completion_code or "",
            trials=max(1, len(row.trials)),
            settled=sum(trial.settled for trial in row.trials),
        )
        for row in study_sessions
    )


@dataclass(frozen=True)
class Check:
    """A count by the participants, compared with the study's.

    Attributes
    ----------
    what : str
        What is counted, in words that follow a number.
    happened, counted : int
        The count by the simulated participants, and by the study.
    """

    what: str
    happened: int
    counted: int

    @property
    def agrees(self) -> bool:
        """Whether the study's count is right."""
        return self.happened == self.counted


def checks(
    session: Session,
    acknowledged: Acknowledged,
    participants: Sequence[Person],
    study_sessions: Sequence[SessionProgress],
    *,
    completed_in_report: int,
) -> Iterator[Check]:
    """Yield the counts by the participants, each with the study's count.

    Parameters
    ----------
    acknowledged : Acknowledged
        What participants were told.
    participants : sequence of Person
        All participants.
    study_sessions : sequence of SessionProgress
        The study sessions in the live view.
    completed_in_report : int
        Completed participants in the report.
    """
    codes = {person.name: person.code for person in participants if person.completed}
    places = select(Place.study_session_id).where(Place.study_session_id.is_not(None))
    held = session.scalars(places).all()
    ended = sum(study_session.standing in ("done", "replaced") for study_session in study_sessions)
    left = sum(study_session.has_left for study_session in study_sessions)
    dropped_out = sum(
        person.rater.kind == "dropping_out" for person in participants if not person.completed
    )
    right_codes = {code for name, code in acknowledged.codes.items() if codes.get(name) == code}
    names = {person.name for person in participants}
    back_and_done = sum(name in codes for name in acknowledged.returned)
    yield Check("participants began", len(names), len(study_sessions))
    yield Check("completed, says the live view", len(acknowledged.codes), ended)
    yield Check("completed, says the report", len(acknowledged.codes), completed_in_report)
    yield Check("left for good", dropped_out, left)
    yield Check("came back after leaving and finished", len(acknowledged.returned), back_and_done)
    yield Check(
        "were shown the code that is stored, each another one",
        len(acknowledged.codes),
        len(right_codes),
    )
    yield Check("places held, each by a study session of its own", len(held), len(set(held)))
    yield from answer_checks(session, acknowledged.answers)


def answer_checks(session: Session, acknowledged: Mapping[AnswerPlace, int]) -> Iterator[Check]:
    """Yield whether `acknowledged` answers are stored once and unchanged."""
    query = select(Trial.token, Response.question, Response.stimulus, Response.value)
    stored: dict[AnswerPlace, list[int]] = {}
    for trial, question, stimulus, value in session.execute(query.join(Response.trial)):
        stored.setdefault((trial, question, stimulus or 0), []).append(value)
    kept = sum(stored.get(place) == [value] for place, value in acknowledged.items())
    yield Check("acknowledged answers, stored once and as they were given", len(acknowledged), kept)
    twice = sum(len(values) - 1 for values in stored.values())
    yield Check("answers stored twice", 0, twice)
