"""A server process of its own that does what it is told, at the same moment as others."""

from __future__ import annotations

import traceback
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import datetime
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.synchronize import Barrier
from typing import Literal, Self

from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import StudySession, Trial
from studyapp.session.answers import store_answers
from studyapp.session.arrivals import Arrival
from studyapp.session.comprehension import start_trials
from studyapp.session.ending import withdraw
from studyapp.session.enrolment import enrol
from studyapp.session.participation import load_situation
from studyapp.session.refusal import ConflictError, RefusalError, StudyFullError
from tests.studyapp.session.ledger import good_value
from tests.support.studies.taking_part_steps import SetClock
from tests.support.studies.three_arms import three_arms

Deed = Literal["arrive", "look", "take trial", "withdraw"]
Outcome = Literal["place", "full", "going on", "answered", "ended", "withdrawn", "refused"]

START_SECONDS = 120


@dataclass(frozen=True, kw_only=True)
class Step:
    """What one participant does."""

    name: str
    deed: Deed


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

    step: Step
    outcome: Outcome
    token: str = ""
    trial: str = ""
    value: int = 0


@dataclass(frozen=True, kw_only=True)
class Round:
    """What one process is to do on a study, while the others do the like."""

    url: str
    places: int
    moment: datetime
    steps: tuple[Step, ...]


class Server:
    """A process with its own connections to the database."""

    def __init__(self, url: str, places: int) -> None:
        self.database = Database.open(url)
        self.served = three_arms(places)
        self.clock = SetClock()

    def do(self, step: Step) -> Done:
        """Do as a participant's browser would, whatever was stored of them before."""
        if step.deed == "arrive":
            try:
                token = enrol(self.database, self.served, Arrival(visit=step.name), self.clock)
            except StudyFullError:
                return Done(step=step, outcome="full")
            return Done(step=step, outcome="place", token=token)
        with self.database.reading() as session:
            wanted = select(StudySession.token).where(StudySession.visit == step.name)
            token = session.scalars(wanted).first() or ""
        done = Done(step=step, outcome="refused", token=token)
        if not token:
            return done
        if step.deed == "withdraw":
            with suppress(ConflictError):
                withdraw(self.database, token, self.clock)
                return replace(done, outcome="withdrawn")
            return done
        if step.deed == "look":
            going_on = (
                load_situation(self.database, self.served, token, self.clock).state == "started"
            )
            return replace(done, outcome="going on" if going_on else "ended")
        return self.take_trial(done)

    def take_trial(self, done: Done) -> Done:
        start_trials(self.database, self.served, done.token, self.clock)
        shown = load_situation(self.database, self.served, done.token, self.clock).trial
        if shown is None:
            return replace(done, outcome="ended")
        with self.database.reading() as session:
            trial = session.scalars(select(Trial).where(Trial.token == shown.token)).one()
            value = good_value(trial.expected or 2)
        fields = {"rhythm": [str(value)], "emotion": [str(value)]}
        try:
            store_answers(self.database, self.served, done.token, shown.token, fields, self.clock)
        except RefusalError:
            return done
        return replace(done, outcome="answered", trial=shown.token, value=value)


def work(orders: Connection, together: Barrier) -> None:
    """Do rounds until there are no more; each begins when all processes are ready for it."""
    servers: dict[tuple[str, int], Server] = {}
    try:
        while (order := orders.recv()) is not None:
            key = (order.url, order.places)
            if key not in servers:
                servers[key] = Server(*key)
            servers[key].clock.moments.append(order.moment)
            together.wait(START_SECONDS)
            orders.send([servers[key].do(step) for step in order.steps])
    except Exception:
        orders.send(traceback.format_exc())
    for server in servers.values():
        server.database.close()


class Crowd:
    """Several processes that do rounds at once."""

    def __init__(self, size: int) -> None:
        spawn = get_context("spawn")
        self.together = spawn.Barrier(size)
        pipes = [spawn.Pipe() for _ in range(size)]
        self.lines = [line for line, _ in pipes]
        self.other_ends = [orders for _, orders in pipes]
        self.processes = [
            spawn.Process(target=work, args=(orders, self.together), daemon=True)
            for orders in self.other_ends
        ]

    def __enter__(self) -> Self:
        for process in self.processes:
            process.start()
        # A process that dies is then noticed, by the end of what it says.
        for orders in self.other_ends:
            orders.close()
        return self

    def __exit__(self, *_: object) -> None:
        for line in self.lines:
            with suppress(OSError):
                line.send(None)
        for process in self.processes:
            process.join(START_SECONDS)
            process.kill()

    def do(self, rounds: Sequence[Round]) -> list[Done]:
        """Let each process do its round, and return all that came of it."""
        for line, order in zip(self.lines, rounds, strict=True):
            line.send(order)
        said = [line.recv() for line in self.lines]
        failures = [report for report in said if isinstance(report, str)]
        assert not failures, failures[0]
        return [done for report in said for done in report]
