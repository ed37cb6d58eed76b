"""The simulated participants of a rehearsal, as its database knows them."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session, selectinload

from studyapp.database.tables import StudySession
from studyapp.rehearsal.eyes import rater_name
from studyapp.rehearsal.record import Truth
from studyapp.rehearsal.simulation.conduct import Conduct
from studyapp.rehearsal.simulation.raters import Rater


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
