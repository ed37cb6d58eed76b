"""A participant's browser without scripts."""

from __future__ import annotations

from collections.abc import Iterator

from flask import Flask
from flask.testing import FlaskClient

from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.page_reader import PageReader

ANSWERS = {"rhythm": "1", "emotion": "-2"}
WATCHED = {"batch": 0, "intervals": [[0.0, 2.0]]}


class Visitor:
    """A browser without scripts, on a server whose clock the test moves."""

    def __init__(self, app: Flask, clock: SetClock) -> None:
        self.client: FlaskClient = app.test_client()
        self.clock = clock
        self.address = ""

    def enrol(self, query: str = "") -> Visitor:
        consent = PageReader(self.client.get(f"/{query}").text)
        hidden = {str(i["name"]): str(i["value"]) for i in consent.soup.select("[type=hidden]")}
        answer = self.client.post(consent.action, data=hidden)
        assert answer.status_code == 303
        self.address = answer.location
        return self

    def begin(self) -> Visitor:
        assert self.client.post(self.page().action).status_code == 303
        return self

    def page(self) -> PageReader:
        answer = self.client.get(self.address)
        assert answer.status_code == 200
        return PageReader(answer.text)

    def watch(self) -> None:
        """Play every video of the present trial to its end, one after the other."""
        for video in self.page().soup.select("video"):
            self.clock.advance(seconds=3)
            self.client.get(str(video["src"]), buffered=True)
            address = str(video["data-watched-url"])
            assert self.client.post(address, json=WATCHED).status_code == 200

    def take_trials(self) -> Iterator[PageReader]:
        """Answer every trial after handing out its page."""
        while (page := self.page()).soup.select("#answers"):
            yield page
            self.watch()
            assert self.post(page)[0] == 303

    def post(self, page: PageReader, **changes: str) -> tuple[int, PageReader]:
        data = {"trial": page.trial, **ANSWERS, **changes}
        answer = self.client.post(page.action, data=data)
        return answer.status_code, PageReader(answer.text)
