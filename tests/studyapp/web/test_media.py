from __future__ import annotations

import socket
from pathlib import Path

import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.tables import StudySession, Video
from studyapp.study.media import read_stimuli, write_stimuli
from studyapp.web.worker import StudyWorker
from tests.studyapp.web.visitor import Visitor, stored_in
from tests.support.studies.added_condition import make_videos_anew
from tests.support.studies.taking_part_steps import SetClock


@pytest.fixture
def address(app: Flask, clock: SetClock) -> str:
    """Return where the present video of a participant is."""
    Visitor(app, clock).enrol().begin().page()
    token = stored_in(app, select(Video.token).order_by(Video.id))[0]
    return f"/media/{token}.mp4"


def content(app: Flask, address: str) -> bytes:
    sent: bytes = app.test_client().get(address, buffered=True).data
    return sent


@pytest.mark.parametrize(
    ("requested", "start", "stop"),
    [("0-", 0, None), ("10-19", 10, 20), ("-5", -5, None)],
)
def test_a_byte_range_is_exactly_what_was_asked_for(
    app: Flask, address: str, requested: str, start: int, stop: int | None
) -> None:
    whole = content(app, address)

    answer = app.test_client().get(address, headers={"Range": f"bytes={requested}"}, buffered=True)

    part = whole[start:stop]
    first = start % len(whole)
    assert (answer.status_code, answer.data) == (206, part)
    assert answer.headers["Content-Length"] == str(len(part))
    assert answer.headers["Content-Range"] == (
        f"bytes {first}-{first + len(part) - 1}/{len(whole)}"
    )


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Range": "bytes=99999999-"}, 416),
        ({"If-Range": '"x"', "Range": "bytes=1-2"}, 200),
        ({"Range": "nonsense"}, 200),
    ],
)
def test_where_a_range_cannot_hold_all_or_nothing_is_sent(
    app: Flask, address: str, headers: dict[str, str], status: int
) -> None:
    answer = app.test_client().get(address, headers=headers, buffered=True)
    head = app.test_client().head(address, buffered=True)

    assert answer.status_code == status
    assert (answer.data == content(app, address)) is (status == 200)
    assert (head.data, int(head.headers["Content-Length"])) == (b"", len(content(app, address)))


def test_a_worker_says_nothing_of_the_request_that_failed() -> None:
    class Log:
        said = ""

        def error(self, words: str, *values: object) -> None:
            self.said += words % values

    worker = StudyWorker.__new__(StudyWorker)
    worker.log = Log()
    failure = RuntimeError("/take/secret")
    ours, theirs = socket.socketpair()
    with ours, theirs:
        try:
            raise failure
        except RuntimeError as error:
            worker.handle_error(None, ours, ("203.0.113.9", 1), error)
        answer = theirs.recv(1000)

    assert answer.startswith(b"HTTP/1.1 500")
    assert "RuntimeError" in worker.log.said
    assert "secret" not in worker.log.said


def test_nobody_is_shown_a_video_that_is_rendered_anew_while_it_is_served(
    app: Flask, address: str, clock: SetClock, tiny_study: Path
) -> None:
    before = read_stimuli(tiny_study / "stimuli.json")
    make_videos_anew(tiny_study)

    (token,) = stored_in(app, select(StudySession.token))
    requested = (address, "/", f"/take/{token}")
    for each in requested:
        answer = app.test_client().get(each)
        assert answer.status_code == 409
        assert "has just been changed" in answer.text

    write_stimuli(tiny_study / "stimuli.json", before)
    for each in requested:
        assert app.test_client().get(each, buffered=True).status_code == 200
