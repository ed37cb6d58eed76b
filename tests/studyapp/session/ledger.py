"""What the bookkeeping of places must come to, kept by hand beside the database."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from datetime import datetime, timedelta

from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import Place, StudySession, Trial
from tests.support.studies.three_arms import LEASE_MINUTES, PRESENTATIONS

PlaceKey = tuple[str, int]


@dataclass(kw_only=True)
class Person:
    """Somebody who got a place; the trials are known from then on."""

    name: str
    token: str
    place: PlaceKey
    trials: list[str]
    catch: dict[str, int]
    last_active: datetime
    begun: bool = False
    shown: int = 0
    answers: list[int] = field(default_factory=list)
    code: str | None = None
    withdrawn: bool = False

    @classmethod
    def read(cls, database: Database, name: str, token: str) -> Person:
        """Return the participant as enrolment made them."""
        with database.reading() as session:
            known = session.scalars(select(StudySession).where(StudySession.token == token)).one()
            assert known.number is not None
            return cls(
                name=name,
                token=token,
                place=(known.arm, known.number),
                trials=[trial.token for trial in known.trials],
                catch={trial.token: trial.expected for trial in known.trials if trial.expected},
                last_active=known.last_active_at,
            )

    @property
    def over(self) -> bool:
        """Whether they have finished or withdrawn."""
        return self.withdrawn or len(self.answers) == PRESENTATIONS

    @property
    def excluded(self) -> bool:
        """Whether the catch trial was failed."""
        return any(
            trial in self.catch and value != good_value(self.catch[trial])
            for trial, value in zip(self.trials, self.answers, strict=False)
        )


@dataclass(kw_only=True)
class Ledger:
    """Who holds which place."""

    arms: Collection[str]
    places: int
    holders: dict[PlaceKey, Person] = field(default_factory=dict)

    def counts(self, *, without: Collection[PlaceKey] = ()) -> dict[str, int]:
        """Return how many places of each arm are held."""
        held = [place for place in self.holders if place not in without]
        return {name: sum(arm == name for arm, _ in held) for name in self.arms}

    def silent(self, now: datetime) -> set[PlaceKey]:
        """Return the places of the unfinished who have done nothing for longer than the lease."""
        since = now - timedelta(minutes=LEASE_MINUTES)
        return {
            place
            for place, person in self.holders.items()
            if not person.over and person.last_active < since
        }

    def holds(self, person: Person) -> bool:
        """Tell whether `person` holds their place."""
        return self.holders.get(person.place) is person

    def come_back(self, person: Person) -> bool:
        """Give who returns the place if it is free and wanted; tell whether they have it."""
        free = person.place not in self.holders
        if free and not person.over and self.counts()[person.place[0]] < self.places:
            self.holders[person.place] = person
        return self.holds(person)

    def leave(self, person: Person) -> None:
        """Give back the place of `person`."""
        if self.holds(person):
            del self.holders[person.place]


def good_value(expected: int) -> int:
    """Return an answer that prefers the stimulus of the number `expected`."""
    return -1 if expected == 1 else 1


def holders_stored(database: Database) -> dict[PlaceKey, str]:
    """Return the token of whoever holds each place that is held."""
    with database.reading() as session:
        rows = session.execute(
            select(Place.arm, Place.number, StudySession.token).join(Place.study_session)
        )
        return {(arm, number): token for arm, number, token in rows}


def answers_stored(database: Database) -> dict[str, list[int]]:
    """Return each participant's answers to the first question, in the order of the trials."""
    answers: dict[str, list[int]] = {}
    with database.reading() as session:
        for known in session.scalars(select(StudySession)):
            trials = sorted(known.trials, key=lambda trial: trial.position)
            answers[known.token] = [value for trial in trials for value in _values(trial)]
    return answers


def _values(trial: Trial) -> list[int]:
    """Return the answer to the first question, once for each time it is stored."""
    given = [known for known in trial.responses if known.question == "rhythm"]
    assert len(trial.responses) == 2 * len(given)
    return [known.value for known in given]
