"""Many concurrent simulated participants, as fast as possible or at a human pace."""

import asyncio
import random
import time
from collections.abc import AsyncIterator, Coroutine, Iterable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, replace

from benchmarks.server.visitor import Ledger, StrandedError, Visitor
from benchmarks.server.wire import Wire
from tests.support.servers.study_server import HOST


@asynccontextmanager
async def beside(others: Iterable[Coroutine[None, None, None]]) -> AsyncIterator[None]:
    """Run `others` during the block, and stop them at its end."""
    tasks = [asyncio.create_task(other) for other in others]
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        for task in tasks:
            with suppress(asyncio.CancelledError):
                await task


@dataclass(frozen=True, kw_only=True)
class Arrived:
    """A participant at the first trial, and that trial's page."""

    visitor: Visitor
    address: str
    page: str


async def arrive(port: int, *, count: int, seed: int, ledger: Ledger) -> list[Arrived]:
    """Let `count` participants arrive at once, and bring each to the first trial.

    Results go to `ledger`; participants who could not begin are not returned.
    """

    async def arrival(number: int) -> Arrived | None:
        visitor = Visitor(wire=Wire(HOST, port), ledger=ledger, chance=_chance(seed, number))
        with suppress(StrandedError):
            address = await visitor.enrol()
            page = await visitor.begin(address)
            # The server may close the connection before all have arrived.
            visitor.wire.close()
            return Arrived(visitor=visitor, address=address, page=page)
        return None

    came = await asyncio.gather(*(arrival(number) for number in range(count)))
    return [arrived for arrived in came if arrived is not None]


async def judge(arrived: list[Arrived], *, ledger: Ledger, seconds: float) -> None:
    """Let everybody who has `arrived` take trials for `seconds` or until they finish.

    Results go to `ledger`; being cut short at the end is not an error.
    """
    async with beside(_trials(arrival, ledger) for arrival in arrived):
        await asyncio.sleep(seconds)
    for arrival in arrived:
        arrival.visitor.wire.close()


async def keep_arriving(port: int, *, at_once: int, seconds: float, ledger: Ledger) -> None:
    """Let newcomers arrive for `seconds`, `at_once` at a time, each as soon as one has a place."""
    end = time.perf_counter() + seconds

    async def one_after_the_other(number: int) -> None:
        async with Wire(HOST, port) as wire:
            visitor = Visitor(wire=wire, ledger=ledger, chance=_chance(0, number))
            while time.perf_counter() < end:
                with suppress(StrandedError):
                    await visitor.enrol()

    await asyncio.gather(*(one_after_the_other(number) for number in range(at_once)))


async def live(port: int, *, count: int, seconds: float, ledger: Ledger) -> None:
    """Let `count` participants take part in real time for `seconds`.

    They arrive within the first third, at different times.
    """

    async def arrival(number: int) -> None:
        chance = _chance(1, number)
        await asyncio.sleep(chance.uniform(0, seconds / 3))
        async with Wire(HOST, port) as wire:
            visitor = Visitor(wire=wire, ledger=ledger, chance=chance, in_real_time=True)
            with suppress(StrandedError):
                await visitor.take_part()

    tasks = [asyncio.create_task(arrival(number)) for number in range(count)]
    await asyncio.wait(tasks, timeout=seconds)
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


def _chance(seed: int, number: int) -> random.Random:
    return random.Random(f"{seed} {number}")  # noqa: S311 - repeatable, not secret


async def _trials(arrived: Arrived, ledger: Ledger) -> None:
    # The ledger records what went wrong.
    with suppress(StrandedError):
        await replace(arrived.visitor, ledger=ledger).go_on(arrived.address, arrived.page)
