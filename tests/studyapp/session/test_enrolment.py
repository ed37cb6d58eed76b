"""Who is admitted, and who holds which place, also when many come at once."""

import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from sqlalchemy import select
from sqlalchemy.pool import QueuePool

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import Newcomer, Place, StudySession
from studyapp.monitoring.overview import overview
from studyapp.session.enrolment import Arrival, enrol, require_admission
from studyapp.session.intake import add_places, change_intake, take_allocation_turn
from studyapp.session.places import release_stale_places, take_open_place
from studyapp.session.refusal import (
    ConflictError,
    CrowdedAddressError,
    StudyFullError,
    UnprovenError,
)
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import find_study_session
from studyapp.session.versions import open_study
from tests.studyapp.session.conftest import held_places
from tests.studyapp.session.ledger import answer_well
from tests.support.studies.stored import found_in
from tests.support.studies.taking_part_steps import Participant, SetClock
from tests.support.studies.three_arms import three_arms

NAMED = Arrival(recruiter_participant="p", recruiter_study="s", recruiter_session="1")
P = Arrival(recruiter_participant="p")


@pytest.mark.parametrize(
    ("first", "second", "same"),
    [
        (Arrival(visit="one"), Arrival(visit="one"), True),
        (NAMED, replace(NAMED, recruiter_study="t"), True),
        (replace(P, visit="one"), replace(P, visit="one"), True),
        (P, replace(P, is_signed=True), True),
        (NAMED, Arrival(visit="two"), False),
        (NAMED, replace(NAMED, recruiter_participant="q"), False),
    ],
)
def test_only_the_same_participant_continues_a_session(
    opened: Database,
    served: ServedStudy,
    clock: SetClock,
    first: Arrival,
    second: Arrival,
    same: bool,
) -> None:
    token = enrol(opened, served, first, clock)

    assert (enrol(opened, served, second, clock) == token) is same
    assert held_places(opened) == (1 if same else 2)


def test_a_name_alone_has_to_wait_and_never_gets_the_code(participant: Participant) -> None:
    named, clock = Arrival(recruiter_participant="p"), participant.clock
    somebody = replace(named, recruiter_session="another")
    owner = participant.another().arrive(named)
    with pytest.raises(UnprovenError, match="another browser"):
        participant.another().arrive(somebody)
    owner.begin().take_all()
    clock.advance(days=1)
    with pytest.raises(UnprovenError, match="already taken part"):
        participant.another().arrive(named)
    returning = participant.another().arrive(replace(named, token=owner.token))
    assert returning.token == owner.token

    # Somebody who continues after a long pause without proof cannot withdraw.
    other = replace(named, recruiter_participant="q")
    silent = participant.another().arrive(other)
    clock.advance(minutes=46)
    assert participant.another().arrive(other).token == silent.token
    with pytest.raises(ConflictError, match="only knew the participant ID"):
        silent.withdraw()


def test_places_per_network_address_and_hour_are_limited(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    recruitment = served.study.recruitment.model_copy(update={"newcomers_per_address": 2})
    limited = replace(served, study=served.study.model_copy(update={"recruitment": recruitment}))

    def arrive(number: int, address: str | None) -> str:
        return enrol(opened, limited, Arrival(visit=f"visit {number}", address=address), clock)

    tokens = [arrive(number, "192.0.2.1") for number in range(2)]
    late = Arrival(visit="visit 2", address="192.0.2.1")
    with pytest.raises(CrowdedAddressError):
        require_admission(opened, limited, late, clock)
    with pytest.raises(CrowdedAddressError):
        arrive(2, "192.0.2.1")
    assert arrive(1, "192.0.2.1") == tokens[1]
    arrive(3, "192.0.2.2")
    clock.advance(minutes=61)
    arrive(2, "192.0.2.1")
    assert len(found_in(opened, select(Newcomer))) == 1


@pytest.mark.parametrize("database_url", ["postgresql"], indirect=True)
def test_many_arrivals_leave_connections_for_answers(participant: Participant) -> None:
    database, served, clock = participant.database, participant.served, participant.clock
    participant.take_trial()
    many = 20
    connections = database.engine.pool
    assert isinstance(connections, QueuePool)
    assert many > connections.size() + connections._max_overflow
    begun = threading.Barrier(many + 1)

    def arrive(number: int) -> str:
        begun.wait(timeout=60)
        return enrol(database, served, Arrival(visit=f"visit {number % 3}"), clock)

    with ThreadPoolExecutor(many) as pool:
        with database.writing() as session:
            take_allocation_turn(session)
            arrivals = [pool.submit(arrive, number) for number in range(many)]
            begun.wait(timeout=60)
            participant.take_trial()
        tokens = {arrival.result() for arrival in arrivals}

    assert len(tokens) == 3
    assert held_places(database) == 4


@pytest.mark.parametrize("database_url", ["postgresql"], indirect=True)
def test_the_study_is_full_only_once_the_last_place_is_taken(
    database: Database, clock: SetClock
) -> None:
    served = three_arms(1)
    open_study(database, served, clock)
    arrivals = [Arrival(visit=f"visit {number}") for number in range(3)]

    with ThreadPoolExecutor(1) as pool:
        with database.writing() as failing:
            place = take_open_place(failing, dict.fromkeys(served.arms, 1))
            for arrival in arrivals[:2]:
                enrol(database, served, arrival, clock)
            last = pool.submit(enrol, database, served, arrivals[2], clock)
            with pytest.raises(TimeoutError):
                last.result(timeout=0.2)
            failing.rollback()
        assert last.result(timeout=60)

    assert place is not None
    assert held_places(database) == 3


def let_in(database: Database, clock: SetClock, places: int, count: int) -> list[Participant]:
    """Open the study with `places` in each of its three arms, and let `count` newcomers in."""
    first = Participant(database, three_arms(places), clock).in_study(three_arms(places))
    earlier = len(found_in(database, select(StudySession.id)))
    return [first.another().enrol(f"visit {earlier + number}") for number in range(count)]


def finish(participant: Participant) -> None:
    participant.begin()
    while (shown := participant.look().trial) is not None:
        answer_well(participant, shown.token)


def test_a_watch_report_restores_a_lost_place(participant: Participant) -> None:
    token = participant.trial().videos[0].token
    participant.fetch(token)
    participant.clock.advance(minutes=46)
    with participant.database.writing() as session:
        release_stale_places(session, participant.served, participant.clock.now())
    assert held_places(participant.database) == 0

    watched = participant.report(token, (0.0, 1.0))

    assert watched.intervals == ((0.0, 1.0),)
    assert participant.look().state == "started"


@pytest.mark.parametrize("database_url", ["postgresql"], indirect=True)
def test_a_participant_who_is_answering_keeps_the_place(
    database: Database, clock: SetClock
) -> None:
    silent, *others = let_in(database, clock, 1, 3)
    for other in others:
        finish(other)
    clock.advance(minutes=46)

    with database.writing() as at_work:
        find_study_session(at_work, silent.token)
        with pytest.raises(StudyFullError):
            let_in(database, clock, 1, 1)

    let_in(database, clock, 1, 1)
    assert silent.look().state == "lapsed"


def test_a_removed_place_is_not_given_back_to_returners(
    database: Database, clock: SetClock
) -> None:
    for participant in let_in(database, clock, 1, 3):
        finish(participant)
    silent = let_in(database, clock, 2, 3)
    clock.advance(minutes=46)
    # This one gets the place of one of the three; the other two places are open then.
    let_in(database, clock, 2, 1)

    fewer = [participant.in_study(three_arms(1)).look().state for participant in silent]

    assert fewer == ["lapsed"] * 3
    assert sum(participant.look().state == "instructed" for participant in silent) == 2


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
    assert len(found_in(opened, select(Place))) == 6
