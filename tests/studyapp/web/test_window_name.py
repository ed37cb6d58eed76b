from __future__ import annotations

from flask import Flask

from studyapp.web.app import window_name
from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.visitor import Visitor


def test_windows_of_one_participant_find_each_other_and_nobody_elses() -> None:
    assert window_name("a" * 32) == window_name("a" * 32)
    assert window_name("a" * 32) != window_name("b" * 32)


def test_a_windows_name_does_not_hold_the_address(app: Flask, clock: SetClock) -> None:
    visitor = Visitor(app, clock).enrol()
    token = visitor.address.rsplit("/", 1)[1]

    named = visitor.page().value("#elsewhere", "data-window")

    assert named == window_name(token)
    assert not any(named[at : at + 6] in token for at in range(len(named) - 5))


def test_pages_that_are_the_end_give_way_to_nobody(app: Flask, clock: SetClock) -> None:
    visitor = Visitor(app, clock).enrol()
    visitor.client.post(f"{visitor.address}/withdraw")

    assert visitor.page().soup.select("#elsewhere") == []
