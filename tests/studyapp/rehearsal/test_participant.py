"""Simulated participants in the real application, with pages spoilt on their way."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import httpx
import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.tables import Response
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.simulation.judgement import Judgement
from studyapp.rehearsal.visit import InterruptedRehearsal, Visit
from studyapp.study.folder import StudyFolder
from studyapp.web.app import create_app
from studyapp.web.running import EXTENSION
from tests.studyapp.rehearsal.steps import SPEED, answering, browser
from tests.studyapp.session.test_form_answers import FORM


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
    made = create_app(folder.root, rehearsal_speed=SPEED)
    with closing(made.extensions[EXTENSION].database), browser(made) as client:
        assert replace(participant, study=folder.study()).take_part(client)


@pytest.mark.parametrize(
    ("lost", "named"),
    [
        ('id="answers"', "no form with the id 'answers'"),
        ('name="emotion"', "does not ask the question 'emotion'"),
        ("<video", "has no video"),
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
    def stopping(visit: Visit, page: Page, judgement: Judgement) -> Page:
        participant.stop.set()
        return visit.send(page, page.answer_form, judgement.fields())

    stopped = answering(participant, stopping)
    with browser(app) as client, pytest.raises(InterruptedRehearsal):
        stopped.take_part(client)
    with eyes.database.reading() as session:
        assert session.scalars(select(Response)).first() is None
