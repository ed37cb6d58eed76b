"""A backup taken while participants answer has everything acknowledged before it."""

from __future__ import annotations

import asyncio
import random
from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from sqlalchemy import select

from studyapp.clock import Clock
from studyapp.custody.backup import Backup, back_up
from studyapp.custody.restoration import restore
from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables import Place, Response, StudySession, Trial
from studyapp.rehearsal.bookkeeping import AnswerPlace
from studyapp.study.folder import StudyFolder
from tests.support.servers.databases import BACKENDS, Backend
from tests.support.servers.study_server import HOST, study_server
from tests.support.servers.throwaway_postgresql import programs, throwaway_postgresql
from tests.support.servers.visitor import Ledger, Visitor
from tests.support.servers.wire import Wire
from tests.support.studies.fabricated_study import StudyShape, write_fabricated_study

PEOPLE = 12
TRIALS = 5
ANSWERS = PEOPLE * TRIALS * 2
SHAPE = StudyShape(
    places=PEOPLE, trials=TRIALS - 1, practice=0, catch=1, seconds=2.0, file_bytes=20_000
)

Given = dict[AnswerPlace, int]
"""The answers to some trials."""


@dataclass
class Crowd:
    """Participants who answer at the same time.

    Attributes
    ----------
    ledger : Ledger
        What they were told.
    addresses : list of str
        The address where each of them continues.
    is_backed_up : Event
        What one of them waits for at the first trial.
    """

    ledger: Ledger = field(default_factory=Ledger)
    addresses: list[str] = field(default_factory=list)
    is_backed_up: asyncio.Event = field(default_factory=asyncio.Event)

    def answers(self) -> Given:
        return dict(self.ledger.acknowledged)

    async def go_on_together(self, port: int, addresses: list[str]) -> None:
        await asyncio.gather(*(self.go_on(port, address) for address in addresses))

    async def take_part(self, port: int, seed: int) -> None:
        async with Wire(HOST, port) as wire:
            visitor = self.visitor(wire, seed)
            address = await visitor.enrol()
            self.addresses.append(address)
            page = await visitor.begin(address)
            if seed == 0:
                await self.is_backed_up.wait()
            await visitor.go_on(address, page)

    async def go_on(self, port: int, address: str) -> None:
        async with Wire(HOST, port) as wire:
            visitor = self.visitor(wire, len(address))
            page = (await wire.get(address, {"Accept": "text/html"})).body.decode()
            await visitor.go_on(address, page)

    def visitor(self, wire: Wire, seed: int) -> Visitor:
        chance = random.Random(seed)  # noqa: S311 - it must be repeatable, not secret
        return Visitor(wire=wire, ledger=self.ledger, chance=chance, patient=True)


async def backed_up_meanwhile(
    crowd: Crowd, port: int, take: Callable[[], Backup]
) -> tuple[Given, Backup]:
    """Let the crowd take part, and back up when a third of all answers has been acknowledged.

    Returns
    -------
    dict
        What had been acknowledged when the backup began.
    Backup
    """
    people = [asyncio.create_task(crowd.take_part(port, seed)) for seed in range(PEOPLE)]
    while len(crowd.ledger.acknowledged) < ANSWERS // 3 and not crowd.ledger.errors:
        await asyncio.sleep(0.01)
    before = crowd.answers()
    made = await asyncio.to_thread(take)
    crowd.is_backed_up.set()
    await asyncio.gather(*people)
    return before, made


def stored(url: str) -> tuple[Given, list[str], int]:
    """Return all answers, the tokens of the unfinished, and how many places are held."""
    database = Database.open(url)
    with database.reading() as session:
        answers = [
            ((each.trial.token, each.question, each.stimulus or 0), each.value)
            for each in session.scalars(select(Response))
        ]
        answered = session.scalars(select(Trial.token).where(Trial.answered_at.is_not(None)))
        assert Counter(trial for (trial, *_), _ in answers) == dict.fromkeys(answered, 2)
        assert len(dict(answers)) == len(answers)
        unfinished = session.scalars(
            select(StudySession.token).where(StudySession.completed_at.is_(None))
        ).all()
        held = session.scalars(select(Place).where(Place.study_session_id.is_not(None))).all()
    database.close()
    return dict(answers), list(unfinished), len(held)


@pytest.mark.slow
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_backup_under_load_has_every_acknowledged_answer_without_an_interruption(
    backend: Backend, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if backend == "postgresql" and programs() is None:
        pytest.skip("PostgreSQL is not installed")
    live, copy = StudyFolder(tmp_path / "live"), StudyFolder(tmp_path / "copy")
    live.root.mkdir()
    write_fabricated_study(live.root, SHAPE)
    with ExitStack() as stack:
        urls = [sqlite_url(live.responses), sqlite_url(copy.responses)]
        if backend == "postgresql":
            server = stack.enter_context(throwaway_postgresql(durable=False))
            urls = [server.url, server.create_database("restored")]
        crowd = Crowd()
        monkeypatch.setenv("DATABASE_URL", urls[0])
        with study_server(live.root, tmp_path / "said", database_url=urls[0]) as serving:
            before, made = asyncio.run(
                backed_up_meanwhile(
                    crowd,
                    serving.port,
                    lambda: back_up(live, tmp_path / "out.tar", Clock(), media=True),
                )
            )
        assert crowd.ledger.errors == []
        everything = crowd.answers()
        assert len(everything) == ANSWERS

        monkeypatch.setenv("DATABASE_URL", urls[1])
        assert restore(made.path, copy, Clock()).missing == ()
        answers, unfinished, held = stored(urls[1])
        assert len(before) >= ANSWERS // 3
        assert before.items() <= answers.items() <= everything.items()
        assert held == made.manifest.participants

        again = Crowd()
        addresses = [each for each in crowd.addresses if each.rsplit("/", 1)[-1] in unfinished]
        assert len(addresses) == len(unfinished) > 0
        with study_server(copy.root, tmp_path / "said", database_url=urls[1]) as serving:
            asyncio.run(again.go_on_together(serving.port, addresses))
        assert again.ledger.errors == []
        finished, nobody, _ = stored(urls[1])
        assert nobody == []
        assert answers.items() <= finished.items()
        assert again.answers() == dict(finished.items() - answers.items())
