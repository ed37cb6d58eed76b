"""Simulated participants in the real application, with pages spoilt on their way."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from threading import Event

import httpx
import pytest
from flask import Flask

from studyapp.definition.folder import StudyFolder
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.participant import InterruptedRehearsal, Participant, Visit
from studyapp.rehearsal.population import default_population
from studyapp.rehearsal.probes import probe_trial
from studyapp.services.database import Database, sqlite_url
from studyapp.web.app import create_app
from studyapp.web.running import EXTENSION
from tests.studyapp.services.test_form_answers import FORM

SPEED = 200.0


class SpoiltTransport(httpx.WSGITransport):
    """Changes pages on their way to the participant."""

    def __init__(self, app: Flask, spoil: Callable[[str], str]) -> None:
        super().__init__(app)
        self.spoil = spoil

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        response = super().handle_request(request)
        if not response.headers.get("content-type", "").startswith("text/html"):
            return response
        html = self.spoil(response.read().decode())
        headers = {k: v for k, v in response.headers.items() if k.lower() != "content-length"}
        return httpx.Response(response.status_code, headers=headers, text=html)


@pytest.fixture
def app(folder: StudyFolder) -> Iterator[Flask]:
    made = create_app(folder.root, rehearsal_speed=SPEED)
    with closing(made.extensions[EXTENSION].database):
        yield made


@pytest.fixture
def eyes(folder: StudyFolder, app: Flask) -> Iterator[Eyes]:
    with closing(Database.open(sqlite_url(folder.rehearsal))) as database:
        yield Eyes(database)


@pytest.fixture
def participant(folder: StudyFolder, eyes: Eyes) -> Participant:
    return Participant(
        entrance="/?PROLIFIC_PID=p1&STUDY_ID=s&SESSION_ID=x",
        questions=("rhythm", "emotion"),
        about={},
        population=default_population(folder.study()),
        seed=1,
        eyes=eyes,
        speed=SPEED,
        stop=Event(),
    )


def browser(app: Flask, spoil: Callable[[str], str] = str) -> httpx.Client:
    return httpx.Client(
        transport=SpoiltTransport(app, spoil), base_url="http://study.test", follow_redirects=True
    )


def test_the_link_opened_again_shows_the_same_completion_code(
    app: Flask, participant: Participant
) -> None:
    with browser(app) as client:
        code = participant.take_part(client)
    with browser(app) as client:
        assert participant.take_part(client) == code


def test_questions_about_the_participant_are_answered_wherever_they_come(
    folder: StudyFolder, participant: Participant
) -> None:
    definition = folder.definition
    definition.write_text(definition.read_text("utf-8") + FORM, "utf-8")
    form = folder.study().form
    about = {f"form:{q.name}": q.example for stage in form.stages() for q in form.asked(stage)}
    made = create_app(folder.root, rehearsal_speed=SPEED)
    with closing(made.extensions[EXTENSION].database), browser(made) as client:
        assert replace(participant, about=about).take_part(client)


@pytest.mark.parametrize(
    ("lost", "named"),
    [
        ('id="answers"', "no form with the id 'answers'"),
        ('name="emotion"', "does not ask the question 'emotion'"),
        ('id="pair"', "no video with the id 'pair'"),
        ("data-watched-url", "without data-watched-url"),
        ('name="trial"', "hidden field 'trial'"),
        ('method="post"', "no form that leads on"),
        ('type="submit" class="primary" id="next"', "no button"),
    ],
)
def test_a_page_that_lacks_something_stops_the_participant_and_is_named(
    app: Flask, participant: Participant, lost: str, named: str
) -> None:
    spoilt = 'type="button"' if "submit" in lost else ""
    with (
        browser(app, lambda html: html.replace(lost, spoilt)) as client,
        pytest.raises(BrokenPageError, match=named),
    ):
        participant.take_part(client)


def test_a_page_that_fails_stops_the_participant_with_its_status(
    app: Flask, participant: Participant
) -> None:
    with (
        browser(app, lambda html: html.replace("/begin", "/begun")) as client,
        pytest.raises(BrokenPageError, match=r"/begun.*status 404"),
    ):
        participant.take_part(client)


def test_a_page_that_only_leads_back_to_itself_is_left(participant: Participant) -> None:
    circle = "<h1>Start</h1><form method='post'><button>Go</button></form>"
    transport = httpx.MockTransport(lambda _: httpx.Response(200, html=circle))
    with (
        httpx.Client(transport=transport, base_url="http://study.test") as client,
        pytest.raises(BrokenPageError, match="'Start' comes back"),
    ):
        participant.take_part(client)


def test_a_video_of_somebody_else_is_not_judged(app: Flask, participant: Participant) -> None:
    def swapped(html: str) -> str:
        return html.replace('src="/media/', 'src="/media/x')

    with (
        browser(app, swapped) as client,
        pytest.raises(BrokenPageError, match="no trial of this rehearsal"),
    ):
        participant.take_part(client)


def test_a_stopped_rehearsal_sends_no_answer(
    app: Flask, participant: Participant, eyes: Eyes
) -> None:
    pages: list[Page] = []

    def stopping(visit: Visit, page: Page, answers: dict[str, str]) -> Page:
        pages.append(page)
        participant.stop.set()
        return visit.send(page.answer_form(), answers)

    stopped = replace(participant, answer_first=stopping)
    with browser(app) as client, pytest.raises(InterruptedRehearsal):
        stopped.take_part(client)
    assert eyes.stored(pages[0]) == ()


def test_bad_submissions_are_refused_and_the_good_answer_is_stored(
    app: Flask, participant: Participant, eyes: Eyes
) -> None:
    answers = {"rhythm": "1", "emotion": "-2"}
    with browser(app) as client:
        visit, page = at_first_trial(client, participant)
        following, probes = probe_trial(visit, page, answers, eyes, gated=True)
    assert [probe.status for probe in probes] == [422, 422, 422, 422, 403, 200, 409]
    assert eyes.stored(page) == ((1, "emotion", -2), (1, "rhythm", 1))
    assert following.answer_form().trial != page.answer_form().trial


def test_a_server_that_takes_bad_answers_is_found_out(
    app: Flask, participant: Participant, eyes: Eyes
) -> None:
    """Played as having been watched already, the pair is answered by what should be refused."""
    with browser(app) as client:
        visit, page = at_first_trial(client, participant)
        visit.watch(page)
        with pytest.raises(BrokenPageError, match="before the videos were watched, and stored it"):
            probe_trial(visit, page, {"rhythm": "1", "emotion": "-2"}, eyes, gated=True)


def at_first_trial(client: httpx.Client, participant: Participant) -> tuple[Visit, Page]:
    visit = Visit(client=client, stop=Event(), speed=SPEED)
    page = visit.open(participant.entrance)
    while not page.asks:
        page = visit.send(page.next_form())
    return visit, page
