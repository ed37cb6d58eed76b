"""How long others wait while a participant floods the server with reports of what was played.

Participants take part in real time. Beside them, in turns of equal length, one more does nothing,
or sends the largest reports there are without a pause, from a process of its own. The ratio is that
of the others' slowest answers (p99), turn by turn. To measure it alone:
``python -m benchmarks.server.report_flood``.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import multiprocessing
import random
import tempfile
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from dataclasses import dataclass, field, replace
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks.server.load import Arrived, arrive, beside
from studyapp.session.watch_evidence import MAX_INTERVALS, MAX_REPORTS
from tests.support.servers.databases import BACKENDS, FreshDatabase, fresh_database
from tests.support.servers.page_scan import SeenVideo, seen_videos
from tests.support.servers.study_server import HOST, study_server
from tests.support.servers.visitor import Kind, Ledger, StrandedError, Visitor
from tests.support.servers.wire import LostConnectionError, Wire
from tests.support.studies.fabricated_study import StudyShape, write_fabricated_study

OTHERS: Final = 192
"""Participants who take part in real time."""

PAIRS: Final = 12
"""Turns without the flood, each followed by one with it."""

BEFORE: Final = 20.0
"""Seconds after which everybody is somewhere in a trial: it takes about as long."""

STORED: Final[tuple[Kind, ...]] = ("answers", "watched")
"""Requests that are acknowledged when what they bring is stored: answers, and what was played."""


@dataclass
class Waits:
    """How long the others' requests took, in seconds, turn by turn.

    Attributes
    ----------
    without, beside : list of list of float
        Of each turn without the flood, and of the one with it that followed.
    """

    without: list[list[float]] = field(default_factory=list)
    beside: list[list[float]] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    @property
    def ratio(self) -> float:
        """How many times as long the p99 is with the flood: the median over all pairs of turns.

        What else the machine does for a moment falls into few pairs.
        """
        pairs = zip(self.without, self.beside, strict=True)
        return float(np.median([p99_ms(beside) / p99_ms(without) for without, beside in pairs]))


def report_flood_waits(folder: Path, database: FreshDatabase, seconds: float) -> Waits:
    """Serve the study in `folder`, and measure it in turns of `seconds`."""
    log = folder / "said"
    # The clock runs as it does for people: nobody may send more than a page does.
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
    """Give what lets a participant flood the server at `port` while it is set."""
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
                # In this process nothing else is waiting.
                flooding.wait()
                with suppress(LostConnectionError):
                    await wire.post(address, body, "application/json", accept="application/json")


def _largest_report(video: SeenVideo, batch: int) -> bytes:
    step = video.duration / MAX_INTERVALS
    intervals = [[part * step, (part + 0.001) * step] for part in range(MAX_INTERVALS)]
    return json.dumps({"batch": batch, "intervals": intervals}).encode()


def p99_ms(seconds: list[float]) -> float:
    """Return the 99th percentile in milliseconds; NaN without any request."""
    return 1000 * float(np.quantile(seconds, 0.99)) if seconds else float("nan")


def main() -> None:
    """Measure on both databases, and print what others wait for without the flood and with it."""
    parser = argparse.ArgumentParser(description="Measure what a flood of reports costs others.")
    parser.add_argument("--seconds", type=float, default=4.0, help="of each turn")
    parser.add_argument("--database", choices=BACKENDS, action="append", help="of both, only this")
    options = parser.parse_args()
    for backend in options.database or BACKENDS:
        with tempfile.TemporaryDirectory(prefix="bench-") as name:
            folder = Path(name)
            write_fabricated_study(folder, StudyShape(places=5000))
            with fresh_database(backend, folder) as database:
                waits = report_flood_waits(folder, database, options.seconds)
        for name, turns in (("without", waits.without), ("beside", waits.beside)):
            p99 = np.median([p99_ms(turn) for turn in turns])
            print(f"{backend}_{name}_flood_p99_ms: {p99:.1f}")
        print(f"{backend}_report_flood_p99_ratio: {waits.ratio:.2f}")
        print(f"{backend}_report_flood_errors: {len(waits.errors)}", flush=True)


if __name__ == "__main__":
    main()
