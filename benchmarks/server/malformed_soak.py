"""Sending malformed requests to the server: none may make it fail or change anything stored."""

import asyncio
import random
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from benchmarks.server.databases import Backend, fresh_database
from benchmarks.server.fabricated_study import StudyShape, write_fabricated_study
from benchmarks.server.log_secrets import secrets_in
from benchmarks.server.malformed_requests import Known, malformed_requests
from benchmarks.server.page_scan import seen_form, seen_videos
from benchmarks.server.visitor import Ledger, Visitor
from benchmarks.server.wire import Wire
from studyapp.database.engine import Database
from tests.support.servers.study_server import HOST, study_server
from tests.support.studies.stored import everything_stored

AT_ONCE: Final = 16
ANSWER_SECONDS: Final = 30.0
PARTICIPANTS: Final = 4
AS_HTTP_ASKS: Final = (501, 505)
"""Expected statuses for an unknown method or version of HTTP."""

NO_ANSWER: Final = 0
"""The server closed the connection without an answer."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """The result of a soak.

    Attributes
    ----------
    answers : mapping of int to int
        Number of answers by status; 0 if the connection was closed without an answer.
    problems : tuple of str
        Problems found; empty if all is well.
    """

    answers: Counter[int]
    problems: tuple[str, ...]


def malformed_soak(backend: Backend, *, requests: int, seed: int) -> Outcome:
    """Send `requests` malformed requests to a server on `backend`."""
    shape = StudyShape(places=20, trials=3, practice=0, catch=1, file_bytes=50_000)
    with tempfile.TemporaryDirectory(prefix="soak-") as name:
        folder = Path(name)
        write_fabricated_study(folder, shape)
        log = folder / "server.log"
        with (
            fresh_database(backend, folder) as database,
            study_server(folder, log, database_url=database.url) as server,
        ):
            known = asyncio.run(_participants(server.port))
            before = _stored(database.url)
            sent = malformed_requests(requests, known, seed)
            answers = asyncio.run(_send(server.port, sent))
            problems = []
            if _stored(database.url) != before:
                problems.append("something was stored or changed")
            asyncio.run(_participants(server.port))
        problems += [f"the log holds {secret}" for secret in secrets_in(log)]
    problems += [
        f"{count} answers with status {status}"
        for status, count in answers.items()
        if status >= 500 and status not in AS_HTTP_ASKS
    ]
    return Outcome(answers=answers, problems=tuple(problems))


def _stored(url: str) -> dict[str, str]:
    with closing(Database.open(url)) as database:
        return everything_stored(database)


async def _participants(port: int) -> Known:
    """Bring a few participants to their first trial, and return the tokens that they know.

    They have fetched its videos, whose first request is stored.
    """
    pages, trials, videos = [], [], []
    ledger = Ledger()
    for number in range(PARTICIPANTS):
        async with Wire(HOST, port) as wire:
            chance = random.Random(number)  # noqa: S311 - it must be repeatable, not secret
            visitor = Visitor(wire=wire, ledger=ledger, chance=chance)
            address = await visitor.enrol()
            page = await visitor.begin(address)
            form = seen_form(page)
            pages.append(address)
            trials += [form.hidden["trial"]] if form else []
            for video in seen_videos(page):
                await wire.get(video.source)
                videos.append(video.source.removeprefix("/media/").removesuffix(".mp4"))
    return Known(pages=pages, trials=trials, videos=videos)


async def _send(port: int, requests: Iterator[bytes]) -> Counter[int]:
    answers: Counter[int] = Counter()

    async def some() -> None:
        # All share one iterator: each takes the next request when it is done with one.
        for request in requests:
            answers[await _status(port, request)] += 1

    await asyncio.gather(*(some() for _ in range(AT_ONCE)))
    return answers


async def _status(port: int, request: bytes) -> int:
    """Send `request` and return the status of the answer."""
    reader, writer = await asyncio.open_connection(HOST, port)
    try:
        async with asyncio.timeout(ANSWER_SECONDS):
            with suppress(ConnectionError):
                writer.write(request)
                # Tell a server that waits for the rest that nothing follows.
                writer.write_eof()
                # An interim "100 Continue" may precede the answer.
                while (line := await reader.readline()) != b"":
                    if line.startswith(b"HTTP/") and not line.startswith(b"HTTP/1.1 1"):
                        return int(line.split(b" ")[1])
    finally:
        writer.close()
    return NO_ANSWER
