"""What a participant must never be able to learn from pages, scripts and headers."""

import re
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from types import FrameType
from typing import Any

import pytest
from flask import Flask
from sqlalchemy import select, update
from sqlalchemy.orm import selectinload
from werkzeug.test import TestResponse

from studyapp.database.tables.study_session import Place
from studyapp.database.tables.trial import Trial
from studyapp.web.site import attach, site_of
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.visitor import ANSWERS, WATCHED, Visitor, stored_in
from tests.support.studies.taking_part_steps import SetClock

CONDITIONS = r"rule_based|mismatched|broken|ground_truth|Ours \(full"
SECRETS = re.compile(
    rf"{CONDITIONS}|robin|take-\d|catch|\bmain\b(?!>)|repeat|expected|\.wav|videos/", re.I
)
LOADED = select(Trial).order_by(Trial.position).options(selectinload(Trial.videos))
TOKEN = re.compile(r"[A-Za-z0-9_-]{32}")
STATIC = Path(__file__).parents[3] / "studyapp" / "web" / "static"
LABELLED = ("[conditions.mismatched]", '[conditions.mismatched]\nlabel = "Ours (full)"')

Request = Callable[[], TestResponse]


def trial_requests(visitor: Visitor) -> dict[str, Request]:
    """Return the requests with which a browser takes the present trial, by name and in order."""
    page, client = visitor.page(), visitor.client
    visitor.clock.advance(seconds=4)
    watched = page.value("#pair", "data-watched-url")
    data = {"trial": page.trial, **ANSWERS}
    return {
        "page": partial(client.get, visitor.address),
        "video": partial(client.get, page.value("#pair", "src"), buffered=True),
        "watched": partial(client.post, watched, json=WATCHED),
        "answered": partial(client.post, page.action, data=data),
    }


def test_no_page_or_header_reveals_a_condition_segment_or_kind(
    serve: Serve, clock: SetClock
) -> None:
    visitor = Visitor(serve(LABELLED), clock)
    seen = [visitor.client.get("/")]
    seen.append(visitor.client.get(visitor.enrol().address))
    visitor.begin()
    for _ in range(6):
        requests = trial_requests(visitor)
        video = requests.pop("video")()
        seen += [request() for request in requests.values()]
        assert SECRETS.findall(TOKEN.sub("", str(video.headers))) == []
    seen.append(visitor.client.get(visitor.address))

    for answer in seen:
        assert SECRETS.findall(TOKEN.sub("", f"{answer.headers}\n{answer.text}")) == []


@pytest.mark.parametrize("script", sorted(STATIC.iterdir()), ids=lambda path: path.name)
def test_scripts_and_styles_do_not_mention_conditions(script: Path) -> None:
    assert re.findall(CONDITIONS, script.read_text("utf-8")) == []


FIGURES = (
    *("figures/strip-take-0.png", "figures/grid-take-0.mp4"),
    *("videos/sheet/index.html", "videos/sheet/.cells/0.webp"),
)
"""Files that name the conditions, in the study folder."""


def test_figures_and_contact_sheets_are_not_served(app: Flask, tiny_study: Path) -> None:
    for file in FIGURES:
        path = tiny_study / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"which condition is which")
    roots = ("/", "/media/", "/media/../", "/media/..%2f", "/media/%2e%2e/", "/static/..%2f..%2f")
    for root, file, ending in product(roots, FIGURES, ("", ".mp4")):
        answer = app.test_client().get(f"{root}{file}{ending}")
        assert answer.status_code in (308, 404), f"{root}{file}{ending}"


def settled(visitor: Visitor) -> None:
    visitor.begin().watch()
    assert visitor.post(visitor.page())[0] == 303


def completed(visitor: Visitor) -> None:
    assert len(list(visitor.begin().take_trials())) == 6


def withdrawn(visitor: Visitor) -> None:
    visitor.begin()
    assert visitor.client.post(f"{visitor.address}/withdraw").status_code == 303


def lapsed(visitor: Visitor) -> None:
    visitor.begin()
    with site_of(visitor.app).database.writing() as session:
        session.execute(update(Place).values(study_session_id=None))


OVER: list[tuple[Callable[[Visitor], Any], int]] = [
    *((happens, 0) for happens in (settled, completed, withdrawn, lapsed, Visitor.page)),
    (completed, 5),
    *((Visitor.begin, index) for index in (2, 5)),
]
"""What happens, and which trial's video is not to be had then."""

ASKED: list[tuple[str, dict[str, str]]] = [
    ("GET", {}),
    ("HEAD", {}),
    ("GET", {"Range": "bytes=0-99"}),
    ("GET", {"Range": "bytes=99999999-"}),
    ("GET", {"If-None-Match": "*"}),
    ("GET", {"If-Modified-Since": "Thu, 01 Jan 2026 00:00:00 GMT"}),
    ("GET", {"Range": "bytes=0-99", "If-Range": "a"}),
]


@pytest.mark.parametrize(("happens", "index"), OVER)
def test_a_token_outside_its_trial_is_answered_like_an_unknown_one(
    app: Flask, clock: SetClock, happens: Callable[[Visitor], Any], index: int
) -> None:
    visitor = Visitor(app, clock).enrol()
    token = list(stored_in(app, LOADED))[index].videos[0].token
    happens(visitor)
    site = site_of(app)

    for (method, headers), prefix in product(ASKED, (None, "/inner/")):
        attach(app, replace(site, accel_prefix=prefix))
        answers = [
            app.test_client().open(
                f"/media/{name}.mp4", method=method, headers=headers, buffered=True
            )
            for name in (token, "A" * len(token))
        ]
        assert [answer.status_code for answer in answers] == [404, 404]
        assert answers[0].data == answers[1].data
        assert list(answers[0].headers) == list(answers[1].headers)
        assert "X-Accel-Redirect" not in answers[0].headers


def steps(request: Request) -> list[str]:
    """Return which functions of the study app run, one after the other, to answer a request.

    Steps done once for each earlier trial are left out: they reveal only the position.
    """
    ran: list[str] = []

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and "/studyapp/" in frame.f_code.co_filename:
            ran.append(frame.f_code.co_qualname)

    sys.setprofile(note)
    try:
        assert request().status_code in (200, 303)
    finally:
        sys.setprofile(None)
    return [name for name in ran if name != "Trial.settled" and not name.endswith("<genexpr>")]


def test_every_kind_of_trial_and_condition_takes_the_same_steps(
    app: Flask, visitor: Visitor
) -> None:
    kinds = [trial.kind for trial in stored_in(app, LOADED)]
    visitor.page()
    taken = [
        {name: steps(request) for name, request in trial_requests(visitor).items()} for _ in kinds
    ]

    # The first page draws what later ones know, and the last trial has none to fetch ahead.
    middle = slice(1, -1)
    assert {"catch", "main"} <= set(kinds[middle])
    assert all(taken[1].values())
    assert all(trial == taken[1] for trial in taken[middle])
