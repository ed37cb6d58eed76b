"""A participant's browser without scripts, and the stored data."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence

from bs4 import Tag
from flask import Flask
from flask.testing import FlaskClient
from sqlalchemy import Select, select
from werkzeug.test import TestResponse

from studyapp.database.tables.study_session import Place, StudySession
from studyapp.web.site import site_of
from tests.studyapp.web.page_reader import PageReader
from tests.support.studies.stored import Found, found_in
from tests.support.studies.taking_part_steps import SetClock

ANSWERS = {"rhythm": "1", "emotion": "-2"}
WATCHED = {"batch": 0, "intervals": [[0.0, 2.0]]}

MOST_PAGES = 60
"""More than any study of the tests has."""


def stored_in(app: Flask, query: Select[Found]) -> Sequence[Found]:
    """Return the first column of what `query` finds in the database of `app`."""
    return found_in(site_of(app).database, query)


class Visitor:
    """A browser without scripts, on a server whose clock the test moves."""

    def __init__(self, app: Flask, clock: SetClock, first_page: str = "/") -> None:
        self.app = app
        self.client: FlaskClient = app.test_client()
        self.clock = clock
        self.first_page = first_page
        self.address = ""

    def enrol(self, query: str = "") -> Visitor:
        answer = submit(self.client, PageReader(self.client.get(f"/{query}").text))
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

    def watch(self, page: PageReader | None = None) -> None:
        """Play every video of the present trial to its end, one after the other."""
        for video in (page or self.page()).soup.select("video"):
            seconds = float(str(video["data-duration"]))
            self.clock.advance(seconds=seconds + 1)
            self.client.get(str(video["src"]), buffered=True)
            report = {"batch": 0, "intervals": [[0.0, seconds]]}
            assert self.client.post(str(video["data-watched-url"]), json=report).status_code == 200

    def take_trials(self) -> Iterator[PageReader]:
        """Answer every trial after handing out its page."""
        while (page := self.page()).soup.select("#answers"):
            yield page
            self.watch(page)
            assert self.client.post(page.action, data=filled(page)).status_code == 303

    def post(self, page: PageReader, **changes: str) -> tuple[int, PageReader]:
        data = {"trial": page.trial, **ANSWERS, **changes}
        answer = self.client.post(page.action, data=data)
        return answer.status_code, PageReader(answer.text)

    def every_page(self) -> Iterator[PageReader]:
        """Go through a whole study of any kind; also return the responses to invalid forms."""
        page = PageReader(self.client.get(self.first_page).text)
        for _ in range(MOST_PAGES):
            yield page
            if page.soup.select_one("#completion-code"):
                return
            page = yield from self._next(page)
        raise AssertionError(f"no end after {MOST_PAGES} pages")

    def _next(self, page: PageReader) -> Generator[PageReader, None, PageReader]:
        """Yield the responses to invalid forms, and return the page after a valid one."""
        answers = filled(page)
        if page.soup.select("#sound-check"):
            answers["digits"] = self._digits()
        if page.soup.select("#answers"):
            self.watch(page)
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

    def _digits(self) -> str:
        token = self.address.rsplit("/", 1)[1]
        query = select(StudySession.sound_digits).where(StudySession.token == token)
        return stored_in(self.app, query)[0]


def submit(client: FlaskClient, page: PageReader, **answers: str) -> TestResponse:
    """Send the form of `page` with what it carries along, and answers by their question."""
    hidden = {str(i["name"]): str(i["value"]) for i in page.soup.select("[type=hidden]")}
    fields = {f"form:{name}": value for name, value in answers.items()}
    return client.post(page.action, data=hidden | fields)


def is_nobody_stored(app: Flask) -> bool:
    held = select(Place.id).where(Place.study_session_id.is_not(None))
    return not stored_in(app, held) and not stored_in(app, select(StudySession.id))


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
