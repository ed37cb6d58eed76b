"""Speed of the study's server: ``python -m benchmarks.server``.

A real server, as ``motionjury serve`` starts it, runs on SQLite and on PostgreSQL, both writing
every answer through to the disk. Simulated participants take whole study sessions over the
loopback: pages, videos, watch reports, answers. Each sends its next request as soon as the last is
answered. Prints a table, then ``name: value`` lines.

First all participants arrive at once; speed is measured from the first trial on. The processor time
of a request is that of a whole study session of 30 trials, arrival included, divided by its
requests. It is the kernel's count for the server's workers; PostgreSQL's processes and the
simulated participants are listed separately.

The delay that one participant's flood of reports causes others is measured in real time, on a
separate server (`benchmarks.server.report_flood`).

Two more cases measure arrivals, each a first page and the following start. In one, people arrive
and take part in real time: they read, watch and answer at a human pace. In the other, newcomers
come to two server processes one after the other, as fast as they get places.
"""

import argparse
import asyncio
import math
import os
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from benchmarks.server.databases import BACKENDS, Backend, FreshDatabase, fresh_database
from benchmarks.server.fabricated_study import StudyShape, write_fabricated_study
from benchmarks.server.load import arrive, judge, keep_arriving, live
from benchmarks.server.report_flood import STORED, report_flood_waits
from benchmarks.server.slow_readers import slow_readers
from benchmarks.server.visitor import REPORT_EVERY, Kind, Ledger
from tests.support.servers.study_server import StudyServer, study_server

Milliseconds = NDArray[np.float64]

CONCURRENCIES: Final = (1, 8, 32, 128)
STATED: Final = ("sqlite", 32)
"""The row that the last lines report."""

SLOW_READERS: Final = 100
BESIDE: Final = 8
"""Participants who answer while others read slowly."""

IN_REAL_TIME: Final = 256
REAL_SECONDS: Final = 60.0
NEWCOMERS_AT_ONCE: Final = 32
ARRIVAL: Final[tuple[Kind, ...]] = ("consent", "start")

SHAPE: Final = StudyShape(places=5000)
PRESENTATIONS: Final = SHAPE.trials + SHAPE.practice + SHAPE.catch
SITTING: Final = PRESENTATIONS * (2 + 2 * (1 + math.ceil(SHAPE.seconds / REPORT_EVERY)))
"""Requests of a study session after its arrival: page and answers of each trial, file and reports
of each of its two videos."""

WARM_UP_SECONDS: Final = 2.0


@dataclass(frozen=True, kw_only=True)
class Row:
    """One measurement.

    Attributes
    ----------
    requests_per_s : float
        Requests answered per second.
    p50_ms, p99_ms, stored_p99_ms : float
        Quantiles of the duration of a request, and of one that waits for storage, in milliseconds.
    server_cpu_ms, database_cpu_ms, client_cpu_ms : float
        Processor time per request, in milliseconds.
    errors : int
        Requests that failed.
    """

    backend: Backend
    concurrency: int
    requests_per_s: float
    p50_ms: float
    p99_ms: float
    stored_p99_ms: float
    server_cpu_ms: float
    database_cpu_ms: float
    client_cpu_ms: float
    errors: int


COLUMNS: Final = (
    ("database", "{0.backend}"),
    ("at once", "{0.concurrency}"),
    ("requests/s", "{0.requests_per_s:.0f}"),
    ("p50 ms", "{0.p50_ms:.1f}"),
    ("p99 ms", "{0.p99_ms:.1f}"),
    ("stored p99 ms", "{0.stored_p99_ms:.1f}"),
    ("server CPU ms", "{0.server_cpu_ms:.2f}"),
    ("database CPU ms", "{0.database_cpu_ms:.2f}"),
    ("client CPU ms", "{0.client_cpu_ms:.2f}"),
    ("errors", "{0.errors}"),
)


def main() -> None:
    """Measure, and print the table and the last lines."""
    parser = argparse.ArgumentParser(description="Measure the study's server.")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each measurement")
    seconds = parser.parse_args().seconds
    rows: list[Row] = []
    ratios: dict[Backend, float] = {}
    floods: dict[Backend, float] = {}
    arrivals: list[str] = []
    print("  ".join(title for title, _ in COLUMNS))
    for backend in BACKENDS:
        with tempfile.TemporaryDirectory(prefix="bench-") as name:
            folder = Path(name)
            write_fabricated_study(folder, SHAPE)
            with (
                fresh_database(backend, folder) as database,
                study_server(folder, folder / "said", database_url=database.url) as server,
            ):
                measured(server, database, BESIDE, WARM_UP_SECONDS)
                for concurrency in CONCURRENCIES:
                    rows.append(measured(server, database, concurrency, seconds))
                    print("  ".join(_cells(rows[-1])), flush=True)
                alone = measured(server, database, BESIDE, seconds)
                slow = measured(server, database, BESIDE, seconds, slow=SLOW_READERS)
                ratios[backend] = slow.stored_p99_ms / alone.stored_p99_ms
                arrivals += arrival_lines(server, database, seconds)
                flood = report_flood_waits(folder, database, 0.4 * seconds)
                floods[backend] = flood.ratio
                arrivals.append(f"{backend}_report_flood_errors: {len(flood.errors)}")
    backend, concurrency = STATED
    (stated,) = (row for row in rows if (row.backend, row.concurrency) == STATED)
    print(f"\n{os.cpu_count()} processors. The last lines: {backend}, {concurrency} at once;")
    print("the ratios and the errors are the worst of both databases.")
    for backend, ratio in ratios.items():
        print(f"{backend}_slow_readers_p99_ratio: {ratio:.2f}")
        print(f"{backend}_report_flood_p99_ratio: {floods[backend]:.2f}")
    print("\n".join(arrivals))
    print(f"slow_readers_p99_ratio: {max(ratios.values()):.2f}")
    print(f"report_flood_p99_ratio: {max(floods.values()):.2f}")
    print(f"requests_per_s: {stated.requests_per_s:.0f}")
    print(f"p50_ms: {stated.p50_ms:.1f}")
    print(f"p99_ms: {stated.p99_ms:.1f}")
    print(f"server_cpu_ms_per_request: {stated.server_cpu_ms:.2f}")
    print(f"errors: {sum(row.errors for row in rows)}")


def measured(
    server: StudyServer,
    database: FreshDatabase,
    concurrency: int,
    seconds: float,
    *,
    slow: int = 0,
) -> Row:
    """Return the measurement of `concurrency` participants over `seconds`.

    Meanwhile, `slow` others read slowly.
    """

    async def run() -> Row:
        coming, sitting = Ledger(), Ledger()
        async with slow_readers(server.port, slow):
            idle = _used(server, database)
            arrived = await arrive(server.port, count=concurrency, seed=slow, ledger=coming)
            before, started = _used(server, database), time.perf_counter()
            await judge(arrived, ledger=sitting, seconds=seconds)
            took, after = time.perf_counter() - started, _used(server, database)
        of_arrivals = (before - idle) / concurrency
        of_requests = (after - before) / sitting.requests
        in_all = coming.requests / concurrency + SITTING
        server_ms, database_ms, client_ms = (of_arrivals + SITTING * of_requests) / in_all
        every = [second for taken in sitting.seconds.values() for second in taken]
        return Row(
            backend=database.backend,
            concurrency=concurrency,
            requests_per_s=sitting.requests / took,
            p50_ms=_quantile_ms(every, 0.5),
            p99_ms=_quantile_ms(every, 0.99),
            stored_p99_ms=_quantile_ms(
                [s for kind in STORED for s in sitting.seconds.get(kind, [])], 0.99
            ),
            server_cpu_ms=server_ms,
            database_cpu_ms=database_ms,
            client_cpu_ms=client_ms,
            errors=len(coming.errors) + len(sitting.errors),
        )

    return asyncio.run(run())


def arrival_lines(server: StudyServer, database: FreshDatabase, seconds: float) -> list[str]:
    """Return durations of arrivals and other requests, and the rate and cost of arrivals."""
    backend = database.backend
    lived, coming = Ledger(), Ledger()
    asyncio.run(live(server.port, count=IN_REAL_TIME, seconds=REAL_SECONDS, ledger=lived))
    before, started = _used(server, database), time.perf_counter()
    asyncio.run(
        keep_arriving(server.port, at_once=NEWCOMERS_AT_ONCE, seconds=seconds, ledger=coming)
    )
    took, used = time.perf_counter() - started, _used(server, database) - before
    arrived = len(coming.seconds.get("start", []))
    lines = [f"{backend}_arrivals_per_s: {arrived / took:.0f}"]
    for process, spent in zip(("server", "database", "client"), used, strict=True):
        each = spent / arrived if arrived else math.nan
        lines.append(f"{backend}_arrival_{process}_cpu_ms: {each:.1f}")
    other_kinds = [kind for kind in lived.seconds if kind not in ARRIVAL]
    for name, kinds in (("arrival", ARRIVAL), ("rest", other_kinds)):
        taken = [second for kind in kinds for second in lived.seconds.get(kind, [])]
        for share in (50, 99):
            quantile = _quantile_ms(taken, share / 100)
            lines.append(f"{backend}_real_time_{name}_p{share}_ms: {quantile:.0f}")
    errors = Counter(lived.errors + coming.errors)
    lines += [f"{backend}_arrival_error, {count} times: {what}" for what, count in errors.items()]
    lines.append(f"{backend}_arrival_errors: {errors.total()}")
    return lines


def _used(server: StudyServer, database: FreshDatabase) -> Milliseconds:
    """Return the processor time used so far by server, database and this process."""
    seconds = (server.cpu_seconds(), database.cpu_seconds(), time.process_time())
    return 1000 * np.array(seconds)


def _quantile_ms(seconds: Sequence[float], share: float) -> float:
    return 1000 * float(np.quantile(seconds, share)) if seconds else float("nan")


def _cells(row: Row) -> list[str]:
    return [text.format(row).rjust(len(title)) for title, text in COLUMNS]


if __name__ == "__main__":
    main()
