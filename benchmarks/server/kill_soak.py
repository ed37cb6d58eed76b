"""Killing the server at random moments while participants answer: nothing may be lost or doubled.

Participants repeat unacknowledged requests, as a page's script does. At the end every study session
must have reached its completion code, and every acknowledged answer must be in the database, once
and as it was sent.
"""

import asyncio
import random
import tempfile
from collections import Counter
from collections.abc import Callable
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sqlalchemy import select

from benchmarks.server.databases import Backend, fresh_database
from benchmarks.server.fabricated_study import StudyShape, write_fabricated_study
from benchmarks.server.log_secrets import secrets_in
from benchmarks.server.visitor import Ledger, StrandedError, Visitor
from benchmarks.server.wire import Wire
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Trial
from studyapp.rehearsal.bookkeeping import answer_checks
from tests.support.servers.study_server import HOST, StudyServer, study_server

POLL_SECONDS: Final = 0.01
QUESTIONS: Final = 2
"""Answers to each trial of a fabricated study."""

FINISH_SECONDS: Final = 120.0
"""Seconds that participants have to finish after the last kill."""


@dataclass(frozen=True, kw_only=True)
class Strain:
    """The strain on a server.

    Attributes
    ----------
    sessions : int
        Concurrent study sessions.
    trials : int
        Trials of each session, of all kinds.
    kills : int
        Number of kills.
    seed : int
        Seed of kills and answers.
    """

    sessions: int = 200
    trials: int = 12
    kills: int = 40
    seed: int = 1


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """The result of a soak.

    Attributes
    ----------
    killed : mapping of str to int
        Number of kills by what was killed.
    sent_again : int
        Requests that were repeated because their outcome was unknown.
    acknowledged : int
        Answers that the server acknowledged as stored.
    problems : tuple of str
        Problems found; empty if all is well.
    """

    killed: Counter[str]
    sent_again: int
    acknowledged: int
    problems: tuple[str, ...]


def kill_soak(backend: Backend, strain: Strain) -> Outcome:
    """Kill a server on `backend` as `strain` specifies, and return the outcome."""
    shape = StudyShape(
        places=strain.sessions,
        trials=strain.trials - 1,
        practice=0,
        catch=1,
        seconds=2.0,
        file_bytes=50_000,
    )
    with tempfile.TemporaryDirectory(prefix="soak-") as name:
        folder = Path(name)
        write_fabricated_study(folder, shape)
        log = folder / "server.log"
        with (
            fresh_database(backend, folder) as database,
            study_server(folder, log, database_url=database.url) as server,
        ):
            ledger, killed = asyncio.run(_strained(server, database.crash, strain))
            problems = [*ledger.errors, *_problems(database.url, ledger, strain)]
        problems += [
            f"the log holds {secret}" for secret in secrets_in(log, allowed=("a traceback",))
        ]
    return Outcome(
        killed=killed,
        sent_again=ledger.lost,
        acknowledged=len(ledger.acknowledged),
        problems=tuple(problems),
    )


async def _strained(
    server: StudyServer, crash: Callable[[], None] | None, strain: Strain
) -> tuple[Ledger, Counter[str]]:
    ledger = Ledger()
    killed: Counter[str] = Counter()
    sessions = [
        asyncio.create_task(_session(server.port, ledger, f"{strain.seed} {number}"))
        for number in range(strain.sessions)
    ]
    chance = random.Random(strain.seed)  # noqa: S311 - it must be repeatable, not secret
    kinds = ["worker", "worker", "arbiter", *(["database"] if crash else [])]
    answers = strain.sessions * strain.trials * QUESTIONS
    for number in range(strain.kills):
        # Kills are spread over the answers: a fast machine would answer all before most kills.
        due = (number + chance.random()) / strain.kills * answers
        while len(ledger.acknowledged) < due and not all(task.done() for task in sessions):
            await asyncio.sleep(POLL_SECONDS)
        kind = chance.choice(kinds)
        killed[kind] += 1
        if kind == "worker":
            server.kill_worker(chance)
        elif kind == "arbiter":
            await asyncio.to_thread(server.kill_arbiter)
            await asyncio.to_thread(server.start)
        elif crash is not None:
            await asyncio.to_thread(crash)
    try:
        async with asyncio.timeout(FINISH_SECONDS):
            await asyncio.gather(*sessions)
    except TimeoutError:
        ledger.errors.append("participants were still not done long after the last kill")
    return ledger, killed


async def _session(port: int, ledger: Ledger, seed: str) -> None:
    chance = random.Random(seed)  # noqa: S311 - it must be repeatable, not secret
    async with Wire(HOST, port) as wire:
        visitor = Visitor(wire=wire, ledger=ledger, chance=chance, patient=True)
        # The ledger records why.
        with suppress(StrandedError):
            await visitor.take_part()


def _problems(url: str, ledger: Ledger, strain: Strain) -> list[str]:
    """Return the problems of the database, given the acknowledged answers."""
    with closing(Database.open(url)) as database, database.reading() as session:
        answers = list(answer_checks(session, ledger.acknowledged))
        finished = session.scalars(select(StudySession.completed_at)).all()
        unanswered = session.scalars(select(Trial.token).where(Trial.answered_at.is_(None))).all()
    problems = [
        f"{check.what}: {check.happened}, counted {check.counted}"
        for check in answers
        if not check.agrees
    ]
    for count, what in (
        (len(unanswered), "trials are not answered"),
        (sum(moment is None for moment in finished), "study sessions are not completed"),
        (abs(len(finished) - strain.sessions), "study sessions too many or too few"),
        (strain.sessions - ledger.completed, "participants did not see a completion code"),
    ):
        if count:
            problems.append(f"{count} {what}")
    return problems
