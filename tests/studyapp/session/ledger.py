"""Stored study sessions, and an independent ledger of places."""

from collections.abc import Collection
from dataclasses import dataclass, field
from datetime import datetime, timedelta

from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Trial
from tests.support.studies.stored import found_in
from tests.support.studies.taking_part_steps import Participant
from tests.support.studies.three_arms import LEASE_MINUTES, PRESENTATIONS

PlaceKey = tuple[str, int]


@dataclass(frozen=True, kw_only=True)
class StoredSession:
    """A study session as it is stored.

    Attributes
    ----------
    planned : PlaceKey
        The place it was made for.
    answers : dict of str to list of int
        Answers to the first question, by the token of the trial, in the order of the trials.
    catch : dict of str to int
        The expected answer of each catch trial.
    """

    token: str
    planned: PlaceKey
    place: PlaceKey | None
    last_active: datetime
    code: str | None
    is_withdrawn: bool
    answers: dict[str, list[int]]
    catch: dict[str, int]

    @property
    def is_unfinished(self) -> bool:
        return self.code is None and not self.is_withdrawn


def stored_sessions(database: Database) -> dict[str, StoredSession]:
    """Return every study session, by its participant's name."""
    with database.reading() as session:
        return {
            str(row.visit): StoredSession(
                token=row.token,
                planned=(row.arm, row.number or 0),
                place=(row.place.arm, row.place.number) if row.place else None,
                last_active=row.last_active_at,
                code=row.completion_code,
                is_withdrawn=row.withdrawn_at is not None,
                answers={trial.token: _answers(trial) for trial in row.trials},
                catch={trial.token: trial.expected for trial in row.trials if trial.expected},
            )
            for row in session.scalars(select(StudySession))
        }


def _answers(trial: Trial) -> list[int]:
    """Return the answer to the first question, once for each time it is stored."""
    first = [each.value for each in trial.responses if each.question == "rhythm"]
    assert len(trial.responses) == 2 * len(first)
    return first


def good_value(expected: int) -> int:
    """Return an answer that prefers the stimulus of the number `expected`."""
    return -1 if expected == 1 else 1


def answer_well(participant: Participant, trial: str) -> int:
    """Answer `trial` so that no check is failed, and return the answer."""
    query = select(Trial.expected).where(Trial.token == trial)
    (expected,) = found_in(participant.database, query)
    value = good_value(expected or 2)
    participant.answer(trial, {"rhythm": str(value), "emotion": str(value)})
    return value


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
    """The holder of each place."""

    arms: Collection[str]
    places: int
    holders: dict[PlaceKey, Person] = field(default_factory=dict)

    def counts(self, *, without: Collection[PlaceKey] = ()) -> dict[str, int]:
        """Return how many places of each arm are held."""
        held = [place for place in self.holders if place not in without]
        return {name: sum(arm == name for arm, _ in held) for name in self.arms}

    def silent(self, now: datetime) -> set[PlaceKey]:
        """Return the places of unfinished participants who were inactive for longer than the
        lease."""
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
        """Give a returner the place if it is free and required; return whether they have it."""
        free = person.place not in self.holders
        if free and not person.over and self.counts()[person.place[0]] < self.places:
            self.holders[person.place] = person
        return self.holds(person)

    def leave(self, person: Person) -> None:
        """Give back the place of `person`."""
        if self.holds(person):
            del self.holders[person.place]
