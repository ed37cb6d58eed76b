"""Simulated participants in the real application, with pages spoilt on their way."""

from __future__ import annotations

import httpx
import pytest
from flask import Flask

from studyapp.rehearsal.pages import BrokenPageError
from studyapp.rehearsal.participant import Participant
from tests.studyapp.rehearsal.steps import browser


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
        pytest.raises(BrokenPageError, match="a video that is not of this rehearsal"),
    ):
        participant.take_part(client)
