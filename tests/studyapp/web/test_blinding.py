"""What a participant must never be able to learn from pages, scripts and headers."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from flask import Flask
from flask.testing import FlaskClient
from sqlalchemy import select
from sqlalchemy.orm import selectinload
from werkzeug.test import TestResponse

from studyapp.models import Trial, Video
from studyapp.web.running import running
from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import ANSWERS, WATCHED, Visitor

CONDITIONS = r"rule_based|mismatched|broken|ground_truth"
SECRETS = re.compile(
    rf"{CONDITIONS}|robin|take-\d|catch|\bmain\b(?!>)|repeat|expected|\.wav|videos/", re.I
)
LOADED = select(Trial).order_by(Trial.position).options(selectinload(Trial.videos))
TOKEN = re.compile(r"[A-Za-z0-9_-]{32}")
STATIC = Path(__file__).parents[3] / "studyapp" / "web" / "static"


def everything(response: TestResponse) -> str:
    return f"{response.headers}\n{response.get_data(as_text=True)}"


def visible_secrets(text: str) -> list[str]:
    return SECRETS.findall(TOKEN.sub("", text))


def test_no_page_or_header_tells_a_condition_segment_or_kind(app: Flask, clock: SetClock) -> None:
    visitor = Visitor(app, clock)
    seen = [everything(visitor.client.get("/"))]
    visitor.enrol()
    seen.append(everything(visitor.client.get(visitor.address)))
    visitor.begin()
    for _ in range(6):
        answer = visitor.client.get(visitor.address)
        seen.append(everything(answer))
        page = PageReader(answer.text)
        clock.advance(seconds=4)
        watched = page.value("#pair", "data-watched-url")
        seen.append(everything(visitor.client.post(watched, json=WATCHED)))
        data = {"trial": page.trial, **ANSWERS}
        seen.append(everything(visitor.client.post(page.action, data=data)))
    seen.append(everything(visitor.client.get(visitor.address)))

    for text in seen:
        assert visible_secrets(text) == []


@pytest.mark.parametrize("script", sorted(STATIC.iterdir()), ids=lambda path: path.name)
def test_scripts_and_style_know_nothing_of_conditions(script: Path) -> None:
    assert re.findall(CONDITIONS, script.read_text("utf-8")) == []


def fetch(client: FlaskClient, trial: Trial, **headers: str) -> TestResponse:
    return client.get(f"/media/{trial.videos[0].token}.mp4", headers=headers, buffered=True)


@pytest.fixture
def two_videos(app: Flask, clock: SetClock) -> list[Trial]:
    """Return the present and the following trial of a participant."""
    Visitor(app, clock).enrol().begin().page()
    with app.app_context(), running().database.reading() as session:
        return list(session.scalars(LOADED))[:2]


def test_videos_differ_in_no_header_but_their_length(app: Flask, two_videos: list[Trial]) -> None:
    client = app.test_client()

    answers = [fetch(client, trial) for trial in two_videos]

    headers = [
        {k: v for k, v in answer.headers if k not in ("Content-Length", "Date")}
        for answer in answers
    ]
    assert headers[0] == headers[1]
    assert not {"ETag", "Last-Modified", "Content-Disposition", "Expires"} & set(headers[0])
    assert visible_secrets(str(headers[0])) == []
    assert answers[0].headers["Content-Type"] == "video/mp4"


def test_byte_ranges_are_served(app: Flask, two_videos: list[Trial]) -> None:
    client = app.test_client()
    whole = fetch(client, two_videos[0]).data

    part = fetch(client, two_videos[0], Range="bytes=100-199")

    assert part.status_code == 206
    assert part.data == whole[100:200]
    assert part.headers["Content-Range"] == f"bytes 100-199/{len(whole)}"
    assert fetch(client, two_videos[0], Range="bytes=-10").data == whole[-10:]
    assert fetch(client, two_videos[0], Range=f"bytes={len(whole)}-").status_code == 416


def test_a_range_is_named_alike_for_every_video(app: Flask, two_videos: list[Trial]) -> None:
    client = app.test_client()

    kinds = [sorted(k for k, _ in fetch(client, t, Range="bytes=0-").headers) for t in two_videos]

    assert kinds[0] == kinds[1]


def test_nobody_can_ask_when_a_video_was_made(app: Flask, two_videos: list[Trial]) -> None:
    client = app.test_client()
    dates = [f"Thu, 01 Jan {year} 00:00:00 GMT" for year in (1971, 2000, 2100)]

    statuses = [fetch(client, two_videos[0], **{"If-Modified-Since": d}).status_code for d in dates]

    assert len(set(statuses)) == 1


def test_tokens_tell_nothing_and_never_repeat(app: Flask, clock: SetClock) -> None:
    for _ in range(2):
        Visitor(app, clock).enrol().begin()
    with app.app_context(), running().database.reading() as session:
        tokens = [video.token for video in session.scalars(select(Video))]

    assert len(set(tokens)) == len(tokens) == 12
    assert all(re.fullmatch(r"[A-Za-z0-9_-]{32}", token) for token in tokens)


@pytest.mark.parametrize("token", ["nothing", "..%2Fstudy", "000"])
def test_other_addresses_give_no_file(app: Flask, token: str) -> None:
    assert app.test_client().get(f"/media/{token}.mp4").status_code == 404


def test_a_video_two_ahead_is_not_served(app: Flask, two_videos: list[Trial]) -> None:
    with app.app_context(), running().database.reading() as session:
        third = list(session.scalars(LOADED))[2]

    assert fetch(app.test_client(), third).status_code == 404
