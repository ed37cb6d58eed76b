"""A simulated participant under load: as fast as the server lets it, or as people are."""

import asyncio
import json
import random
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Final, Literal

from benchmarks.server.page_scan import SeenForm, seen_files, seen_form, seen_videos
from benchmarks.server.wire import LostConnectionError, Reply, Wire
from studyapp.rehearsal.bookkeeping import AnswerPlace

Kind = Literal["consent", "start", "begin", "page", "file", "media", "watched", "answers"]
"""What a request is for."""

REPORT_EVERY: Final = 2.0
"""Seconds of a video after which a browser reports what was played."""

READING: Final = (4.0, 20.0)
"""Seconds within which a person has read a page."""

CHOOSING: Final = (2.0, 10.0)
"""Seconds within which a person has answered, once the videos are over."""

SENT_TWICE: Final = 0.05
"""Share of answers that are sent once more, as by a double click."""

COMPLETED: Final = 'id="completion-code"'

RETRY_SECONDS: Final = 0.1
PATIENCE_SECONDS: Final = 60.0
"""After so long without an answer, the most patient participant has given up."""


class StrandedError(Exception):
    """A participant cannot go on."""


@dataclass
class Ledger:
    """What participants have seen of the server.

    Attributes
    ----------
    seconds : mapping of Kind to list of float
        How long each request took.
    errors : list of str
        What went wrong; never an address, which holds a participant's token.
    acknowledged : mapping of AnswerPlace to int
        The answers that the server has said it stored.
    lost : int
        Requests that were sent again because the server went away or failed.
    completed : int
        Study sessions that were taken to their completion code.
    """

    seconds: dict[Kind, list[float]] = field(default_factory=dict)
    errors: list[str] = field(default_factory=list)
    acknowledged: dict[AnswerPlace, int] = field(default_factory=dict)
    lost: int = 0
    completed: int = 0

    @property
    def requests(self) -> int:
        """How many requests were answered."""
        return sum(len(taken) for taken in self.seconds.values())


@dataclass(frozen=True, kw_only=True)
class Visitor:
    """One simulated participant.

    Attributes
    ----------
    wire : Wire
        Its connection.
    ledger : Ledger
        Where it records what it sees.
    chance : Random
        Decides its answers.
    patient : bool
        Whether it sends a request again when the server goes away or fails, as a page's script
        does; otherwise that is an error.
    in_real_time: bool
        Whether it takes the time that people take to read, to watch and to answer.
    """

    wire: Wire
    ledger: Ledger
    chance: random.Random
    patient: bool = False
    in_real_time: bool = False

    async def enrol(self) -> str:
        """Agree to take part, and return the address of the participant's own page."""
        page = await self._ask("consent", lambda: self.wire.get("/"))
        form = self._form(page)
        await self._spend(*READING)
        started = await self._send("start", form, {})
        return started.headers["location"]

    async def begin(self, address: str) -> str:
        """Leave everything that comes before the first trial, and return that trial's page."""
        while True:
            page = await self._page(address)
            form = self._form(page)
            if form.is_trial:
                return page.body.decode()
            await self._spend(*READING)
            await self._send("begin", form, {})

    async def take_part(self) -> None:
        """Take a study session from the first page to the completion code.

        Raises
        ------
        StrandedError
            If a page does not lead on.
        """
        address = await self.enrol()
        await self.go_on(address, await self.begin(address))

    async def go_on(self, address: str, page: str) -> None:
        """Take all trials from the first one, which is on `page`, to the completion code.

        Raises
        ------
        StrandedError
            If a page does not lead on.
        """
        for file in seen_files(page):
            await self._ask("file", lambda file=file: self.wire.get(file))  # type: ignore[misc]
        while COMPLETED not in page:
            page = await self._trial_or_form(address, page)
        self.ledger.completed += 1

    async def _trial_or_form(self, address: str, page: str) -> str:
        form = seen_form(page)
        if form is None:
            raise StrandedError("a page leads nowhere")
        if form.is_trial:
            await self._watch(page)
            await self._answer(form)
        else:
            await self._send("begin", form, {})
        return (await self._page(address)).body.decode()

    async def _watch(self, page: str) -> None:
        """Fetch the videos on `page`, and report that they were played."""
        for video in seen_videos(page):
            source = video.source
            await self._ask("media", lambda: self.wire.get(source, {"Range": "bytes=0-"}))  # noqa: B023
            played, batch = 0.0, 0
            while played < video.duration:
                until = min(video.duration, played + REPORT_EVERY)
                report = {"batch": batch, "intervals": [[played, until]]}
                await self._spend(until - played)
                body, where = json.dumps(report).encode(), video.watched_address
                await self._ask("watched", lambda: self._post_json(where, body))  # noqa: B023
                played, batch = until, batch + 1

    async def _answer(self, form: SeenForm) -> None:
        await self._spend(*CHOOSING)
        answers = {name: self.chance.choice(values) for name, values in form.choices.items()}
        for _ in range(2 if self.chance.random() < SENT_TWICE else 1):
            await self._send("answers", form, answers)
            self.ledger.acknowledged.update(
                {(form.hidden["trial"], name, 0): int(value) for name, value in answers.items()}
            )

    async def _spend(self, least: float, most: float = 0.0) -> None:
        """Wait a person's time, from `least` to `most` seconds."""
        if self.in_real_time:
            await asyncio.sleep(self.chance.uniform(least, max(least, most)))

    async def _page(self, address: str) -> Reply:
        return await self._ask("page", lambda: self.wire.get(address, {"Accept": "text/html"}))

    async def _send(self, kind: Kind, form: SeenForm, answers: dict[str, str]) -> Reply:
        fields = {**form.hidden, **answers}
        return await self._ask(kind, lambda: self.wire.post_form(form.action, fields))

    async def _post_json(self, address: str, body: bytes) -> Reply:
        return await self.wire.post(address, body, "application/json", accept="application/json")

    async def _ask(self, kind: Kind, request: Callable[[], Awaitable[Reply]]) -> Reply:
        end = time.perf_counter() + (PATIENCE_SECONDS if self.patient else 0.0)
        while True:
            started = time.perf_counter()
            try:
                reply = await request()
            except LostConnectionError as error:
                if started > end:
                    self._fail(f"{kind}: {error}")
            else:
                self.ledger.seconds.setdefault(kind, []).append(time.perf_counter() - started)
                if reply.status < 400:
                    return reply
                if reply.status < 500 or started > end:
                    self._fail(f"{kind}: status {reply.status}")
            self.ledger.lost += 1
            await asyncio.sleep(RETRY_SECONDS)

    def _form(self, page: Reply) -> SeenForm:
        form = seen_form(page.body.decode())
        if form is None:
            raise StrandedError("a page leads nowhere")
        return form

    def _fail(self, problem: str) -> None:
        self.ledger.errors.append(problem)
        raise StrandedError(problem)
