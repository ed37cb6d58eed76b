"""A visitor who goes through a whole study, whatever it asks, and hands out every page."""

from __future__ import annotations

from collections.abc import Generator, Iterator

from bs4 import Tag
from flask import Flask
from flask.testing import FlaskClient
from sqlalchemy import select

from studyapp.database.tables import StudySession
from studyapp.web.running import running
from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.page_reader import PageReader

MOST_PAGES = 60
"""More than any study of the tests has."""


class Walker:
    """A participant without scripts, on a server whose clock the test moves."""

    def __init__(self, app: Flask, clock: SetClock, first_page: str = "/") -> None:
        self.app = app
        self.first_page = first_page
        self.client: FlaskClient = app.test_client()
        self.clock = clock
        self.address = ""

    def pages(self) -> Iterator[PageReader]:
        """Yield every page from the first to the completion code, refused ones included."""
        page = PageReader(self.client.get(self.first_page).text)
        for _ in range(MOST_PAGES):
            yield page
            if page.soup.select_one("#completion-code"):
                return
            page = yield from self._next(page)
        raise AssertionError(f"no end after {MOST_PAGES} pages")

    def _next(self, page: PageReader) -> Generator[PageReader, None, PageReader]:
        """Yield what is said to an unusable form, and return the page after a good one."""
        answers = filled(page)
        if page.soup.select("#sound-check"):
            answers["digits"] = self._digits()
        if page.soup.select("#answers"):
            self._watch(page)
        if page.soup.select("main :is(select, [type=radio], [name=digits])"):
            unusable = {
                name: value if is_hidden(page, name) else "" for name, value in answers.items()
            }
            refused = self.client.post(page.action, data=unusable)
            assert refused.status_code == 422
            yield PageReader(refused.text)
        sent = self.client.post(page.action, data=answers)
        if sent.status_code == 303:
            self.address = sent.location
            sent = self.client.get(sent.location)
        assert sent.status_code == 200
        return PageReader(sent.text)

    def _watch(self, page: PageReader) -> None:
        for video in page.soup.select("video"):
            seconds = float(str(video["data-duration"]))
            self.clock.advance(seconds=seconds + 1)
            self.client.get(str(video["src"]), buffered=True)
            report = {"batch": 0, "intervals": [[0.0, seconds]]}
            assert self.client.post(str(video["data-watched-url"]), json=report).status_code == 200

    def _digits(self) -> str:
        token = self.address.rsplit("/", 1)[1]
        with self.app.app_context(), running().database.reading() as session:
            spoken = select(StudySession.sound_digits).where(StudySession.token == token)
            return session.scalars(spoken).one()


def is_hidden(page: PageReader, name: str) -> bool:
    return bool(page.soup.select(f'main form [type=hidden][name="{name}"]'))


def filled(page: PageReader) -> dict[str, str]:
    """Return acceptable answers to the form of `page`: the first choice of everything."""
    form = page.soup.select_one("form#answers") or page.one("main form[method=post]")
    answers: dict[str, str] = {}
    for field in form.select("input[name], select[name], textarea[name]"):
        if field.get("type") != "checkbox":
            answers.setdefault(str(field["name"]), _value(field))
    return answers


def _value(field: Tag) -> str:
    if field.name == "textarea":
        return "–"
    match field.get("type"):
        case "number":
            return str(field["min"])
        case "text":
            return "–"
        case None:  # a rank: in the order of the videos
            return str(field["name"]).partition(":")[2]
        case _:
            return str(field["value"])
