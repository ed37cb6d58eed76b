"""Simulated participants as they and as the database know them, and whether the two agree."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session, selectinload

from studyapp.database.tables import Place, Response, StudySession, Trial
from studyapp.monitoring.counts import dropouts
from studyapp.monitoring.study_sessions import SessionProgress
from studyapp.rehearsal.eyes import rater_name
from studyapp.rehearsal.record import Truth
from studyapp.rehearsal.simulation.judgement import Conduct
from studyapp.rehearsal.simulation.raters import Rater
from studyapp.study.design.trial import Answers

AnswerPlace = tuple[str, str, int]
"""Token of the trial, question, and number of the stimulus (0 for the trial)."""


@dataclass(frozen=True, kw_only=True)
class Acknowledged:
    """All that participants were told is stored.

    Attributes
    ----------
    answers : dict of AnswerPlace to int
        Values.
    codes : dict of str to str
        The completion code of each participant who has one.
    left, returned : Counter of str
        How often each participant left to come back, and came back.
    """

    answers: dict[AnswerPlace, int] = field(default_factory=dict)
    codes: dict[str, str] = field(default_factory=dict)
    left: Counter[str] = field(default_factory=Counter)
    returned: Counter[str] = field(default_factory=Counter)

    @property
    def away(self) -> frozenset[str]:
        """Who has left to come back, and may have come back since."""
        return frozenset(self.left)


@dataclass(frozen=True)
class Ledger:
    """A file with a line for each thing that a participant was told, as soon as it was told.

    It outlives a rehearsal that is stopped anywhere; of what the server did, it holds nothing that
    no participant was told.
    """

    path: Path
    lock: Lock = field(default_factory=Lock, repr=False)

    def answered(self, name: str, trial: str, values: Answers) -> None:
        """Note that the answers to the trial with the token `trial` were taken."""
        said = [[question, stimulus or 0, v] for (question, stimulus), v in values.items()]
        self._add({"participant": name, "trial": trial, "answers": said})

    def completed(self, name: str, code: str) -> None:
        """Note that a participant was shown the completion code."""
        self._add({"participant": name, "code": code})

    def left(self, name: str) -> None:
        """Note that a participant left to come back."""
        self._add({"participant": name, "left": True})

    def returned(self, name: str) -> None:
        """Note that a participant came back."""
        self._add({"participant": name, "returned": True})

    def read(self) -> Acknowledged:
        """Return all that was noted."""
        found = Acknowledged()
        for line in self._lines():
            name = line["participant"]
            for question, stimulus, value in line.get("answers", ()):
                found.answers[line["trial"], question, stimulus] = value
            if "code" in line:
                found.codes[name] = line["code"]
            found.left.update([name] * ("left" in line))
            found.returned.update([name] * ("returned" in line))
        return found

    def remove(self) -> None:
        """Forget everything."""
        self.path.unlink(missing_ok=True)

    def _add(self, line: dict[str, Any]) -> None:
        with self.lock:
            self.path.parent.mkdir(exist_ok=True)
            with self.path.open("a+b") as file:
                # What a run that was killed has left unfinished stays a line of its own.
                if file.tell() and not self._ends_whole():
                    file.write(b"\n")
                file.write(json.dumps(line).encode() + b"\n")

    def _ends_whole(self) -> bool:
        with self.path.open("rb") as file:
            file.seek(-1, 2)
            return file.read(1) == b"\n"

    def _lines(self) -> Iterator[dict[str, Any]]:
        """Yield all lines but those that were never finished."""
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
    """One simulated participant.

    Attributes
    ----------
    study_session : str
        Its number, by which answers are told apart.
    name : str
        What its recruiter calls it.
    rater : Rater
        Who answers.
    completed, has_place : bool
        Whether it has its completion code, and holds a place.
    code : str
        That code, as stored; empty before.
    trials, settled : int
        How many trials it has, and is done with.
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
        """Whether it has left for good: it does so once it sees a certain trial."""
        conduct = Conduct(rater=self.rater, trials=self.trials, coverage=0.0)
        leaves_at = None if conduct.returns else conduct.leaves_at
        return not self.completed and leaves_at is not None and self.settled >= leaves_at - 1


def people(session: Session, truth: Truth) -> tuple[Person, ...]:
    """Return all who began, in the order of their arrival."""
    begun = session.scalars(
        select(StudySession)
        .order_by(StudySession.id)
        .options(selectinload(StudySession.place), selectinload(StudySession.trials))
    )
    return tuple(
        Person(
            study_session=str(each.id),
            name=each.recruiter_participant or "",
            rater=Rater(
                population=truth.population, seed=truth.seed, name=rater_name(session, each)
            ),
            completed=each.completed_at is not None,
            has_place=each.place is not None,
            code=each.completion_code or "",
            trials=max(1, len(each.trials)),
            settled=sum(trial.settled for trial in each.trials),
        )
        for each in begun
    )


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
