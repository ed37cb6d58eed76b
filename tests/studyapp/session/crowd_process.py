"""Server processes that act on command, at the same moment."""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cache
from multiprocessing import get_context
from multiprocessing.synchronize import Barrier
from typing import Literal

from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.session.refusal import ConflictError, RefusalError, StudyFullError
from tests.studyapp.session.ledger import answer_well
from tests.support.studies.taking_part_steps import Participant, SetClock
from tests.support.studies.three_arms import three_arms

Deed = Literal["arrive", "look", "take trial", "withdraw"]
Outcome = Literal["place", "full", "going on", "answered", "ended", "withdrawn", "refused"]
Step = tuple[str, Deed]
"""A participant's name, and what they do."""

PLACES = 3
START_SECONDS = 120
BARRIERS: list[Barrier] = []
"""The one at which this process waits for the others before each round."""


@dataclass(frozen=True, kw_only=True)
class Done:
    """What came of a step.

    Attributes
    ----------
    token : str
        The participant's, where they have one.
    trial : str
        The trial whose answer was acknowledged, if any.
    """

    name: str
    deed: Deed
    outcome: Outcome = "refused"
    token: str = ""
    trial: str = ""
    value: int = 0


def join_crowd(together: Barrier) -> None:
    BARRIERS.append(together)


@contextmanager
def crowd(size: int) -> Iterator[ProcessPoolExecutor]:
    """Start `size` processes, each with its own connections; each takes one round at a time."""
    spawn = get_context("spawn")
    together = spawn.Barrier(size)
    with ProcessPoolExecutor(size, spawn, join_crowd, (together,)) as processes:
        yield processes


def do_round(url: str, moment: datetime, steps: list[Step]) -> list[Done]:
    """Take `steps` as soon as every process has some, while the others act too."""
    participant = participant_on(url)
    participant.clock.moments.append(moment)
    BARRIERS[0].wait(START_SECONDS)
    return [do(participant, *step) for step in steps]


@cache
def participant_on(url: str) -> Participant:
    return Participant(Database.open(url), three_arms(PLACES), SetClock())


def do(participant: Participant, name: str, deed: Deed) -> Done:
    """Do as a participant's browser would, whatever was stored of them before."""
    done = Done(name=name, deed=deed)
    if deed == "arrive":
        try:
            return replace(done, outcome="place", token=participant.enrol(name).token)
        except StudyFullError:
            return replace(done, outcome="full")
    with participant.database.reading() as session:
        query = select(StudySession.token).where(StudySession.visit == name)
        participant.token = session.scalars(query).first() or ""
    if not participant.token:
        return done
    done = replace(done, token=participant.token)
    if deed == "withdraw":
        try:
            participant.withdraw()
        except ConflictError:
            return done
        return replace(done, outcome="withdrawn")
    if deed == "look":
        is_going_on = participant.look().state == "started"
        return replace(done, outcome="going on" if is_going_on else "ended")
    shown = participant.begin().look().trial
    if shown is None:
        return replace(done, outcome="ended")
    try:
        value = answer_well(participant, shown.token)
    except RefusalError:
        return done
    return replace(done, outcome="answered", trial=shown.token, value=value)
