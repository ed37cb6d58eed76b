"""What the application sets up: its clock, how many reports it takes, and windows' names."""

from __future__ import annotations

import resource
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from flask import Flask

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.web.app import create_app, window_name
from studyapp.web.participants import participant
from studyapp.web.protection import AT_ONCE, KEPT, Pace
from tests.studyapp.web.visitor import WATCHED, Visitor
from tests.support.studies.taking_part_steps import SetClock


def test_a_study_that_cannot_be_served_leaves_no_database(tiny_study: Path) -> None:
    (tiny_study / "responses.db").unlink()
    (tiny_study / "stimuli.json").write_text("{", "utf-8")

    with pytest.raises(InputError, match=r"stimuli\.json"):
        create_app(tiny_study)
    assert not (tiny_study / "responses.db").exists()


def accepted(pace: Pace, seconds: float, *, per_second: float) -> int:
    """Return how many reports were accepted that came at even distances, from one participant."""
    moments = [number / per_second for number in range(int(seconds * per_second))]
    return sum(pace.seconds_to_wait("one", moment) == 0 for moment in moments)


def test_a_page_can_report_in_four_windows_for_an_hour() -> None:
    every_two_seconds_and_at_each_end = 0.5 + 0.2

    per_second = 4 * every_two_seconds_and_at_each_end
    assert accepted(Pace(), 3600, per_second=per_second) == int(3600 * per_second)


def test_nobody_else_has_to_wait_however_many_names_are_made_up() -> None:
    pace = Pace()
    for _ in range(AT_ONCE):
        pace.seconds_to_wait("one", 0.0)

    waits = [pace.seconds_to_wait(f"{number}", 0.0) for number in range(KEPT + 10)]

    assert set(waits) == {0.0}
    assert pace.seconds_to_wait("one", 0.0) > 0


def test_what_is_too_much_is_refused_before_it_is_read_and_stops_nobody_else(
    app: Flask, clock: SetClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    flooding, other = (Visitor(app, clock).enrol().begin() for _ in range(2))
    address = flooding.page().value("#pair", "data-watched-url")
    monkeypatch.setattr("studyapp.web.app.time.monotonic", lambda: 7.0)
    for _ in range(AT_ONCE):
        assert flooding.client.post(address, json=WATCHED).status_code != 429
    with monkeypatch.context() as patch:
        patch.delattr(participant, "record_watched")
        refused = flooding.client.post(address, data=b"\xff")

    assert (refused.status_code, refused.headers["Retry-After"]) == (429, "1")
    other.watch()
    assert flooding.client.get(flooding.address).status_code == 200
    monkeypatch.setattr("studyapp.web.app.time.monotonic", lambda: 8.0)
    flooding.watch()


def test_a_windows_name_does_not_hold_the_address(app: Flask, clock: SetClock) -> None:
    visitor = Visitor(app, clock).enrol()
    token = visitor.address.rsplit("/", 1)[1]

    named = visitor.page().value("#elsewhere", "data-window")

    assert named == window_name(token)
    assert not any(named[at : at + 6] in token for at in range(len(named) - 5))


@contextmanager
def full_disk() -> Iterator[None]:
    """Let no file grow, nor be written beyond its first bytes."""
    assert signal.getsignal(signal.SIGXFSZ) is signal.SIG_IGN
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_where_nothing_can_be_written_it_is_not_well(
    app: Flask, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = app.test_client()
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 0.0)
    with full_disk():
        full = client.get("/healthz")
    well = client.get("/healthz")
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 60.0)
    with full_disk():
        asked_again_soon = client.get("/healthz")

    assert (full.status_code, full.text) == (503, "Answers cannot be stored.\n")
    assert (well.status_code, well.text, asked_again_soon.status_code) == (200, "ok\n", 200)
    assert well.headers["Cache-Control"] == "no-store"
    assert "Set-Cookie" not in well.headers


def test_where_the_database_does_not_answer_it_is_not_well_and_says_so_all_the_same(
    app: Flask, monkeypatch: pytest.MonkeyPatch
) -> None:
    thawed, databases = threading.Event(), list[Database]()

    def wait_for_it(database: Database) -> None:
        databases.append(database)
        thawed.wait(60)

    monkeypatch.setattr(Database, "check_writable", wait_for_it)
    monkeypatch.setattr("studyapp.web.app.ANSWER_SECONDS", 0.05)
    monkeypatch.setattr("studyapp.web.app.KNOWN_SECONDS", 0.0)
    client = app.test_client()

    frozen = [client.get("/healthz").status_code for _ in range(3)]
    asked_while_frozen = len(databases)
    thawed.set()
    monkeypatch.setattr("studyapp.web.app.ANSWER_SECONDS", 60.0)

    assert (frozen, asked_while_frozen) == ([503] * 3, 1)
    assert client.get("/healthz").status_code == 200
