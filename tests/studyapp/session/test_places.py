"""Places of active and returning participants, and researchers' decisions about newcomers."""

from __future__ import annotations

import pytest
from sqlalchemy import func, select

from studyapp.database.engine import Database
from studyapp.database.tables import Place, StudySession
from studyapp.monitoring.overview import overview
from studyapp.researchers.audit import latest_changes
from studyapp.session.intake import add_places, change_intake
from studyapp.session.places import release_stale_places
from studyapp.session.refusal import StudyFullError
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import find_study_session
from studyapp.session.versions import open_study
from tests.studyapp.session.ledger import answer_well
from tests.support.studies.taking_part_steps import Participant, SetClock
from tests.support.studies.three_arms import three_arms


def arrive(database: Database, clock: SetClock, places: int, count: int) -> list[Participant]:
    """Open the study with `places` in each of its three arms, and let `count` newcomers in."""
    first = Participant(database, three_arms(places), clock).in_study(three_arms(places))
    with database.reading() as session:
        earlier = session.scalars(select(func.count(StudySession.id))).one()
    return [first.another().enrol(f"visit {earlier + number}") for number in range(count)]


def finish(participant: Participant) -> None:
    participant.begin()
    while (shown := participant.look().trial) is not None:
        answer_well(participant, shown.token)


def test_a_watch_report_restores_a_lost_place(
    participant: Participant,
) -> None:
    token = participant.trial().videos[0].token
    participant.fetch(token)
    participant.clock.advance(minutes=46)
    with participant.database.writing() as session:
        release_stale_places(session, participant.served, participant.clock.now())
        assert session.scalars(select(func.count(Place.study_session_id))).one() == 0

    watched = participant.report(token, (0.0, 1.0))

    assert watched.intervals == ((0.0, 1.0),)
    assert participant.look().state == "started"


@pytest.mark.parametrize("database_url", ["postgresql"], indirect=True)
def test_a_participant_who_is_answering_keeps_the_place(
    database: Database, clock: SetClock
) -> None:
    silent, *others = arrive(database, clock, 1, 3)
    for other in others:
        finish(other)
    clock.advance(minutes=46)

    with database.writing() as at_work:
        find_study_session(at_work, silent.token)
        with pytest.raises(StudyFullError):
            arrive(database, clock, 1, 1)

    arrive(database, clock, 1, 1)
    assert silent.look().state == "lapsed"


def test_a_removed_place_is_not_given_back_to_returners(
    database: Database, clock: SetClock
) -> None:
    for participant in arrive(database, clock, 1, 3):
        finish(participant)
    silent = arrive(database, clock, 2, 3)
    clock.advance(minutes=46)
    # This one gets the place of one of the three; the other two places are open then.
    arrive(database, clock, 2, 1)

    fewer = [participant.in_study(three_arms(1)).look().state for participant in silent]

    assert fewer == ["lapsed"] * 3
    assert sum(participant.look().state == "instructed" for participant in silent) == 2


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
