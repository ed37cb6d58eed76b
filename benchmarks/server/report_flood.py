"""Waiting times of others while a participant floods the server with watch reports.

Participants take part in real time. In turns of equal length, another participant does nothing, or
sends the largest possible reports without a pause, from a separate process. The ratio compares the
p99 of the others' answers, turn by turn. To measure it alone: ``python -m
benchmarks.server.report_flood``.
"""

import asyncio
import json
import multiprocessing
import random
import tempfile
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from dataclasses import replace
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Final

from benchmarks.server.databases import FreshDatabase, fresh_database
from benchmarks.server.fabricated_study import StudyShape, write_fabricated_study
from benchmarks.server.load import Arrived, arrive, beside
from benchmarks.server.page_scan import SeenVideo, seen_videos
from benchmarks.server.turns import Waits, read_options
from benchmarks.server.visitor import Kind, Ledger, StrandedError, Visitor
from benchmarks.server.wire import LostConnectionError, Wire
from studyapp.session.watch_evidence import MAX_INTERVALS, MAX_REPORTS
from tests.support.servers.study_server import HOST, study_server

OTHERS: Final = 192
"""Participants who take part in real time."""

PAIRS: Final = 12
"""Turns without the flood, each followed by one with it."""

BEFORE: Final = 20.0
"""Seconds, about as long as a trial, after which everybody is somewhere in one."""

STORED: Final[tuple[Kind, ...]] = ("answers", "watched")
"""Requests that are acknowledged once stored: answers and watch reports."""


def report_flood_waits(folder: Path, database: FreshDatabase, seconds: float) -> Waits:
    """Serve the study in `folder`, and measure it in turns of `seconds`."""
    log = folder / "said"
    # Real time: nobody may send more than a page would.
    with (
        study_server(folder, log, database_url=database.url, speed=1.0) as server,
        _flooder(server.port) as flooding,
    ):
        return asyncio.run(_measure(server.port, flooding, seconds))


async def _measure(port: int, flooding: Event, seconds: float) -> Waits:
    waits, ledger = Waits(), Ledger()
    arrived = await arrive(port, count=OTHERS, seed=2, ledger=ledger)
    async with _taking_part(arrived, ledger):
        await asyncio.sleep(BEFORE)
        for turn in range(2 * PAIRS):
            if turn % 2:
                flooding.set()
            ledger.seconds = {}
            await asyncio.sleep(seconds)
            flooding.clear()
            taken = [second for kind in STORED for second in ledger.seconds.get(kind, [])]
            (waits.beside if turn % 2 else waits.without).append(taken)
    waits.errors = ledger.errors
    return waits


@asynccontextmanager
async def _taking_part(arrived: list[Arrived], ledger: Ledger) -> AsyncIterator[None]:
    """Let everybody who has `arrived` take part in real time during the block."""

    async def go_on(number: int, arrival: Arrived) -> None:
        await asyncio.sleep(BEFORE * number / len(arrived))
        visitor = replace(arrival.visitor, ledger=ledger, in_real_time=True)
        with suppress(StrandedError):
            await visitor.go_on(arrival.address, arrival.page)

    async with beside(go_on(number, arrival) for number, arrival in enumerate(arrived)):
        yield
    for arrival in arrived:
        arrival.visitor.wire.close()


@contextmanager
def _flooder(port: int) -> Iterator[Event]:
    """Yield an event; while it is set, a participant floods the server at `port`."""
    context = multiprocessing.get_context("spawn")
    flooding = context.Event()
    process = context.Process(target=_flood, args=(port, flooding), daemon=True)
    process.start()
    try:
        yield flooding
        if not process.is_alive():
            raise RuntimeError("the participant who floods the server has given up")
    finally:
        process.terminate()
        process.join()


def _flood(port: int, flooding: Event) -> None:
    asyncio.run(_send_reports(port, flooding))


async def _send_reports(port: int, flooding: Event) -> None:
    async with Wire(HOST, port) as wire:
        chance = random.Random("flood")  # noqa: S311 - repeatable, not secret
        visitor = Visitor(wire=wire, ledger=Ledger(), chance=chance)
        videos = seen_videos(await visitor.begin(await visitor.enrol()))
        reports = [
            (video.watched_address, _largest_report(video, batch))
            for video in videos
            for batch in range(MAX_REPORTS)
        ]
        while True:
            for address, body in reports:
                # Nothing else waits in this process.
                flooding.wait()
                with suppress(LostConnectionError):
                    await wire.post(address, body, "application/json", accept="application/json")


def _largest_report(video: SeenVideo, batch: int) -> bytes:
    step = video.duration / MAX_INTERVALS
    intervals = [[part * step, (part + 0.001) * step] for part in range(MAX_INTERVALS)]
    return json.dumps({"batch": batch, "intervals": intervals}).encode()


def main() -> None:
    """Measure on both databases, and print others' waiting times without and with the flood."""
    options = read_options("Measure what a flood of reports costs others.", seconds=4.0)
    for backend in options.database:
        with tempfile.TemporaryDirectory(prefix="bench-") as name:
            folder = Path(name)
            write_fabricated_study(folder, StudyShape(places=5000))
            with fresh_database(backend, folder) as database:
                waits = report_flood_waits(folder, database, options.seconds)
        waits.print(backend, "flood", total="report_flood")


if __name__ == "__main__":
    main()
