"""Many simulated participants at once, each sending its next request when the last is answered."""

from __future__ import annotations

import asyncio
import random
import time
from contextlib import suppress
from dataclasses import dataclass, replace

from studyapp.bench.study_server import HOST
from studyapp.bench.visitor import Ledger, StrandedError, Visitor
from studyapp.bench.wire import Wire


@dataclass(frozen=True, kw_only=True)
class Arrived:
    """A participant at the first trial, and that trial's page."""

    visitor: Visitor
    address: str
    page: str


async def arrive(port: int, *, count: int, seed: int, ledger: Ledger) -> list[Arrived]:
    """Let `count` participants come at once, and bring each to the first trial.

    What they see is noted in `ledger`; who could not begin is not among those returned.
    """

    async def one(number: int) -> Arrived | None:
        chance = random.Random(f"{seed} {number}")  # noqa: S311 - repeatable, not secret
        visitor = Visitor(wire=Wire(HOST, port), ledger=ledger, chance=chance)
        with suppress(StrandedError):
            address = await visitor.enrol()
            page = await visitor.begin(address)
            # Until all have come the server may close it, just as the next request is sent.
            visitor.wire.close()
            return Arrived(visitor=visitor, address=address, page=page)
        return None

    came = await asyncio.gather(*(one(number) for number in range(count)))
    return [arrived for arrived in came if arrived is not None]


async def judge(arrived: list[Arrived], *, ledger: Ledger, seconds: float) -> None:
    """Let everybody who has `arrived` take trials for `seconds`; who has finished is done.

    What they see is noted in `ledger`; that they are cut short at the end is no error.
    """
    end = time.perf_counter() + seconds
    tasks = [asyncio.create_task(_trials(one, ledger)) for one in arrived]
    await asyncio.sleep(end - time.perf_counter())
    for task in tasks:
        task.cancel()
    for task in tasks:
        with suppress(asyncio.CancelledError):
            await task
    for one in arrived:
        one.visitor.wire.close()


async def _trials(arrived: Arrived, ledger: Ledger) -> None:
    # What went wrong is in the ledger.
    with suppress(StrandedError):
        await replace(arrived.visitor, ledger=ledger).go_on(arrived.address, arrived.page)
