"""Refusals are logged without tokens, and have no other effect."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from urllib.parse import urljoin

from flask import Flask
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import RefusalLine
from studyapp.database.tables.trial import Response, Trial
from studyapp.web.site import attach, site_of
from tests.studyapp.web.visitor import ANSWERS, WATCHED, Visitor, filled, stored_in
from tests.support.servers.both_databases import BOTH
from tests.support.studies.stored import everything_stored
from tests.support.studies.taking_part_steps import Participant, SetClock

TOO_MUCH = "More of the video was reported as played than there was time for."
ANSWERED = "You have already answered this page, and your first answer is stored."


def noted_refusals(app: Flask) -> list[tuple[int | None, str, str]]:
    lines = stored_in(app, select(RefusalLine).order_by(RefusalLine.id))
    return [(line.study_session_id, line.kind, line.detail) for line in lines]


def test_refusals_are_logged_by_kind(app: Flask, visitor: Visitor, clock: SetClock) -> None:
    page = visitor.page()
    watched = page.value("#pair", "data-watched-url")
    other = Visitor(app, clock).enrol().begin().page()

    statuses = [
        visitor.client.post(watched, json=WATCHED).status_code,
        visitor.client.post(watched, json={"batch": -1}).status_code,
    ]
    visitor.watch()
    statuses += [
        visitor.post(page, rhythm="7")[0],
        visitor.post(page, trial=other.trial)[0],
        visitor.client.get("/take/nobody").status_code,
        visitor.post(page)[0],
        visitor.post(page)[0],
        visitor.post(page, rhythm="2")[0],
    ]
    assert statuses == [422, 422, 422, 403, 404, 303, 303, 409]
    stored = stored_in(app, select(Response).order_by(Response.id))
    assert [(row.question, str(row.value)) for row in stored] == list(ANSWERS.items())

    assert noted_refusals(app) == [
        (1, "too-much-watched", f"watched: {TOO_MUCH}"),
        (1, "unacceptable", "watched: This is not a report of played intervals."),
        (1, "unacceptable", "answers: An answer is not one of the choices."),
        (1, "not-theirs", "answers: This page does not belong to you."),
        (None, "unknown-address", "stand: This address belongs to no participant of this study."),
        (1, "stale-page", f"answers: {ANSWERED}"),
    ]


def test_what_no_page_offers_is_refused_and_changes_nothing(
    app: Flask, visitor: Visitor, clock: SetClock
) -> None:
    database, nobody = site_of(app).database, "0" * 32
    others = Visitor(app, clock).enrol().begin()
    page, their_page = visitor.page(), others.page()
    first = filled(page)

    def sent(address: str, **data: object) -> int:
        return visitor.client.post(urljoin(f"{visitor.address}/", address), data=data).status_code

    def reported(video: str) -> int:
        later = WATCHED | {"batch": 999}
        return visitor.client.post(f"{visitor.address}/watched/{video}", json=later).status_code

    def require(*attempts: tuple[int, Callable[[], int]]) -> None:
        before = everything_stored(database)
        assert [attempt() for _, attempt in attempts] == [status for status, _ in attempts]
        assert everything_stored(database) == before

    token = select(Trial.token).where(Trial.position == 2)
    video, their_video = (
        each.value("#pair", "src").rpartition("/")[2].removesuffix(".mp4")
        for each in (page, their_page)
    )
    require(
        (422, lambda: sent("answers", **first)),
        (409, lambda: sent("answers", **first | {"trial": stored_in(app, token)[0]})),
        (403, lambda: reported(nobody)),
        (403, lambda: reported(their_video)),
    )
    visitor.watch()
    require(
        (422, lambda: sent("answers", **first | {"rhythm": ["1", "2"]})),
        (403, lambda: sent("answers", **first | {"trial": nobody})),
        (403, lambda: sent(f"../{others.address.rpartition('/')[2]}/answers", **first)),
        (403, lambda: sent("unplayable", trial=nobody)),
        *(
            (422, partial(sent, "unplayable", trial=page.trial, video=v))
            for v in (nobody, their_video)
        ),
    )
    assert len(list(visitor.take_trials())) == 6
    require(
        (303, lambda: sent("answers", **first)),
        (409, lambda: sent("answers", **first | {"rhythm": "2"})),
        (409, lambda: sent("unplayable", trial=page.trial, video=video)),
        (409, lambda: reported(video)),
        (303, lambda: sent("begin")),
        (409, lambda: sent("withdraw")),
        (404, lambda: sent(f"/take/{nobody}/answers", **first)),
    )


def test_a_report_that_crosses_with_next_is_refused_without_logging(
    app: Flask, visitor: Visitor
) -> None:
    page = visitor.page()
    watched = page.value("#pair", "data-watched-url")
    visitor.watch()
    visitor.post(page)

    assert visitor.client.post(watched, json=WATCHED).status_code == 409
    assert noted_refusals(app) == []


@BOTH
def test_nul_characters_are_refused_everywhere(
    app: Flask, opened: Database, participant: Participant
) -> None:
    attach(app, replace(site_of(app), database=opened))
    client = app.test_client()
    page = f"/take/{participant.token}"
    nowhere = ("/take/%00", "/media/%00.mp4", "/take/%00/withdraw", "/?PROLIFIC_PID=a%00b")

    statuses = {address: client.get(address).status_code for address in nowhere}
    forms = [
        client.post(f"{page}/answers", data={"trial": "a\0b"}).status_code,
        client.post(f"{page}/answers", data={"tri\0al": "a"}).status_code,
        client.post(f"{page}/form/closing", data={"form:remarks": "well\0done"}).status_code,
        client.post("/", data={"visit": "\0" * 32, "form:age": "\0"}).status_code,
    ]

    assert statuses == dict.fromkeys(nowhere, 404)
    assert forms == [400] * 4
