"""Many simulated participants at once, each sending its next request when the last is answered."""

from __future__ import annotations

import asyncio
import random
import time
from contextlib import suppress

from studyapp.bench.study_server import HOST
from studyapp.bench.visitor import Ledger, StrandedError, Visitor
from studyapp.bench.wire import Wire


async def load(port: int, *, concurrency: int, seconds: float, seed: int) -> Ledger:
    """Let `concurrency` participants take study sessions, one after the other, for `seconds`.

    Returns
    -------
    Ledger
        What they saw; sessions that were cut short at the end are no errors.
    """
    ledger = Ledger()
    end = time.perf_counter() + seconds
    async with asyncio.timeout(seconds + 60):
        tasks = [
            asyncio.create_task(_sessions(port, ledger, random.Random(f"{seed} {number}"), end))  # noqa: S311
            for number in range(concurrency)
        ]
        await asyncio.sleep(seconds)
        for task in tasks:
            task.cancel()
        for task in tasks:
            with suppress(asyncio.CancelledError):
                await task
    return ledger


async def _sessions(port: int, ledger: Ledger, chance: random.Random, end: float) -> None:
    while time.perf_counter() < end:
        async with Wire(HOST, port) as wire:
            # What went wrong is in the ledger.
            with suppress(StrandedError):
                await Visitor(wire=wire, ledger=ledger, chance=chance).take_part()
