"""A participant whose browser keeps everything it receives, over a whole study session."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Final

from flask import Flask
from flask.testing import FlaskClient
from sqlalchemy import select
from sqlalchemy.orm import selectinload
from werkzeug.test import TestResponse

from studyapp.database.tables import StudySession, Trial, Video
from studyapp.web.site import site_of
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import filled
from tests.support.studies.taking_part_steps import SetClock

MOST_STEPS: Final = 40

ASKED: Final[tuple[tuple[str, str, dict[str, str]], ...]] = (
    ("whole", "GET", {"Range": "bytes=0-"}),
    ("head", "HEAD", {}),
    ("again", "GET", {"If-Modified-Since": "Thu, 01 Jan 2026 00:00:00 GMT", "If-None-Match": "a"}),
)
"""Name, method and headers of the requests for each video."""


@dataclass(frozen=True)
class Exchange:
    """One answer of the server.

    Attributes
    ----------
    name : str
        What was asked for, such as ``page`` or ``A whole``.
    """

    name: str
    status: int
    headers: tuple[tuple[str, str], ...]
    body: bytes


@dataclass
class RecordedTrial:
    """What was received for one trial, and its truth.

    Attributes
    ----------
    videos : dict of str to list of Exchange
        What came of each video, under its label.
    pages : list of Exchange
        Everything else, in order.
    numbers : dict of str to list of int
        The stimuli that each video shows; the reference has none.
    truth : Trial
        As the server knows it.
    """

    truth: Trial
    videos: dict[str, list[Exchange]] = field(default_factory=dict)
    pages: list[Exchange] = field(default_factory=list)
    numbers: dict[str, list[int]] = field(default_factory=dict)


class RecordingParticipant:
    """Takes part in the study of an application whose clock the test moves."""

    def __init__(self, app: Flask, clock: SetClock) -> None:
        self.app = app
        self.clock = clock
        self.client: FlaskClient = app.test_client()

    def take_part(self) -> list[RecordedTrial]:
        """Take part from the first page to the completion code; return the trials in order."""
        address = self._enrol()
        trials: list[RecordedTrial] = []
        before: list[Exchange] = []
        trial_of_token = {trial.token: trial for trial in self._trials(address.rpartition("/")[2])}
        for _ in range(MOST_STEPS):
            answer = self.client.get(address)
            page = PageReader(answer.text)
            if page.soup.select("#completion-code"):
                assert [trial.truth.position for trial in trials] == [
                    *range(1, len(trial_of_token) + 1)
                ]
                return trials
            if not page.soup.select("#answers"):
                before.append(_exchange("before", answer))
                self._send("between", page)
                continue
            trial = RecordedTrial(trial_of_token[page.trial])
            trial.pages += [*before, _exchange("page", answer)]
            before = self._take(trial, page)
            trials.append(trial)
        raise AssertionError(f"no end after {MOST_STEPS} pages")

    def _enrol(self) -> str:
        sent = self._send("enrol", PageReader(self.client.get("/").text))
        return str(dict(sent.headers)["Location"])

    def _take(self, trial: RecordedTrial, page: PageReader) -> list[Exchange]:
        """Watch and answer one trial; return what came ahead of the next one."""
        numbers = {video.token: [s.number for s in video.stimuli] for video in trial.truth.videos}
        answers = filled(page)
        refused = self.client.post(
            page.action, data=answers, headers={"Accept": "application/json"}
        )
        trial.pages.append(_exchange("refused", refused))
        assert refused.status_code == 422, "answers were taken before anything was played"
        ahead: list[Exchange] = []
        for video in page.soup.select("video"):
            label, address = str(video["data-label"]), str(video["src"])
            token = address.rpartition("/")[2].removesuffix(".mp4")
            trial.numbers[label] = [number for number in numbers[token] if number]
            trial.videos[label] = list(self._fetched(address))
            seconds = float(str(video["data-duration"]))
            self.clock.advance(seconds=seconds + 1)
            report = {"batch": 0, "intervals": [[0.0, seconds]]}
            watched = self.client.post(str(video["data-watched-url"]), json=report)
            trial.videos[label].append(_exchange("watched", watched))
            for following in str(video.get("data-following") or "").split():
                ahead.append(_exchange("ahead", self.client.get(following, buffered=True)))
        trial.pages.append(self._send("answered", page))
        return ahead

    def _fetched(self, address: str) -> Iterator[Exchange]:
        for name, method, headers in ASKED:
            answer = self.client.open(address, method=method, headers=headers, buffered=True)
            yield _exchange(name, answer)

    def _send(self, name: str, page: PageReader) -> Exchange:
        answer = self.client.post(page.action, data=filled(page))
        assert answer.status_code == 303, page.heading
        return _exchange(name, answer)

    def _trials(self, token: str) -> list[Trial]:
        with site_of(self.app).database.reading() as session:
            chosen = select(Trial).join(Trial.study_session).where(StudySession.token == token)
            shown: Any = selectinload(Trial.videos).selectinload(Video.stimuli)
            trials = chosen.options(shown, selectinload(Trial.stimuli))
            return list(session.scalars(trials.order_by(Trial.position)))


def _exchange(name: str, answer: TestResponse) -> Exchange:
    return Exchange(name, answer.status_code, tuple(answer.headers.items()), answer.data)
