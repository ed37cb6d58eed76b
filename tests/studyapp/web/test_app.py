"""What the application sets up: its clock, how many reports it takes, and windows' names."""

from __future__ import annotations

from pathlib import Path

import pytest
from flask import Flask

from motion.errors import InputError
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
