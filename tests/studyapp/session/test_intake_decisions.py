"""Pausing, resuming, extending and closing a running study."""

from __future__ import annotations

import pytest
from sqlalchemy import func, select

from studyapp.database.engine import Database
from studyapp.database.tables import Place
from studyapp.monitoring.overview import overview
from studyapp.researchers.audit import latest_changes
from studyapp.session.intake import add_places, change_intake
from studyapp.session.refusal import StudyFullError
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from tests.support.studies.taking_part_steps import Participant, SetClock


def test_a_closed_intake_refuses_newcomers_and_disturbs_nobody(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    there = Participant(opened, served, clock).enrol("there").begin()

    change_intake(opened, served, clock, "paused", by="Ada", reason="the server moves")

    with pytest.raises(StudyFullError, match=r"paused at the moment\..*come back later"):
        there.another().enrol("new")
    (decision,) = overview(opened, served, clock.now()).decisions
    assert "the study admits nobody new" in decision.what
    there.take_trial()
    again = there.another().enrol("there")
    assert again.token == there.token
    assert again.take_all()
    change_intake(opened, served, clock, "open", by="Ada", reason="it has moved")
    there.another().enrol("new").begin()
    assert [(line.researcher, line.reason) for line in latest_changes(opened)] == [
        ("Ada", "it has moved"),
        ("Ada", "the server moves"),
    ]


def test_extending_a_full_study_admits_that_many_more(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    newcomer = Participant(opened, served, clock)
    for number in range(4):
        newcomer.another().enrol(f"visit {number}").begin().take_trial()
    with pytest.raises(StudyFullError):
        newcomer.enrol("late")

    add_places(opened, served, clock, 1, by="Ada", reason="two were ill")
    change_intake(opened, served, clock, "closed", by="Ada", reason="for a moment")
    add_places(opened, served, clock, 1, by="Ada", reason="one more")
    with pytest.raises(StudyFullError, match="The study is over"):
        newcomer.enrol("late")
    change_intake(opened, served, clock, "open", by="Ada", reason="go on")
    open_study(opened, served, clock)

    for number in range(2):
        newcomer.another().enrol(f"late {number}").begin().take_trial()
    with pytest.raises(StudyFullError):
        newcomer.enrol("too late")
    places = overview(opened, served, clock.now()).places
    assert (places.wanted, places.active, places.open) == (6, 6, 0)
    with opened.reading() as session:
        assert session.scalar(select(func.count()).select_from(Place)) == 6
