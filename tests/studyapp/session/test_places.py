"""Places when people are at work, come back, and when other numbers of them are wanted."""

from __future__ import annotations

from collections import Counter

import pytest
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import Place, StudySession, Trial
from studyapp.session.places import release_stale_places
from studyapp.session.refusal import StudyFullError
from studyapp.session.state import find_study_session
from studyapp.session.versions import open_study
from tests.support.studies.taking_part_steps import Participant, SetClock
from tests.support.studies.three_arms import three_arms

Many = list[Participant]


def arrive(database: Database, clock: SetClock, places: int, count: int) -> Many:
    """Open the study with `places` in each of its three arms, and let `count` newcomers in."""
    served = three_arms(places)
    open_study(database, served, clock)
    with database.reading() as session:
        known = len(session.scalars(select(StudySession.id)).all())
    return [
        Participant(database, served, clock).enrol(f"visit {known + number}")
        for number in range(count)
    ]


def finish(participant: Participant, *, careless: bool = False) -> None:
    participant.begin()
    with participant.database.reading() as session:
        query = (
            select(Trial).join(Trial.study_session).where(StudySession.token == participant.token)
        )
        trials = session.scalars(query).all()
    while (shown := participant.look().trial) is not None:
        expected = next(t.expected for t in trials if t.token == shown.token)
        value = str((1 if expected == 2 else -1) * (-1 if careless else 1))
        participant.answer(shown.token, {"rhythm": value, "emotion": value})


def held(database: Database) -> dict[str, int]:
    with database.reading() as session:
        return dict(
            Counter(session.scalars(select(Place.arm).where(Place.study_session_id.is_not(None))))
        )


def test_a_report_of_what_was_played_gets_a_lost_place_back_and_is_stored(
    participant: Participant,
) -> None:
    token = participant.trial().videos[0].token
    participant.fetch(token)
    participant.clock.advance(minutes=46)
    with participant.database.writing() as session:
        release_stale_places(session, participant.served, participant.clock.now())
    assert not held(participant.database)

    known = participant.report(token, (0.0, 1.0))

    assert known.intervals == ((0.0, 1.0),)
    assert sum(held(participant.database).values()) == 1


@pytest.mark.parametrize("database_url", ["postgresql"], indirect=True)
def test_who_is_answering_at_this_moment_does_not_lose_the_place(
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


def test_fewer_wanted_counts_whoever_is_done_whatever_their_number(
    database: Database, clock: SetClock
) -> None:
    for late in arrive(database, clock, 2, 6)[3:]:
        finish(late)
    clock.advance(minutes=46)

    with pytest.raises(StudyFullError):
        arrive(database, clock, 1, 1)


def test_a_place_that_is_no_longer_wanted_is_not_given_back_to_who_returns(
    database: Database, clock: SetClock
) -> None:
    for participant in arrive(database, clock, 1, 3):
        finish(participant)
    silent = arrive(database, clock, 2, 3)
    clock.advance(minutes=46)
    # This one gets the place of one of the three; the other two places are open then.
    arrive(database, clock, 2, 1)
    open_study(database, three_arms(1), clock)

    states = [
        Participant(database, three_arms(1), clock, participant.token).look().state
        for participant in silent
    ]

    assert states == ["lapsed"] * 3
    assert sum(participant.look().state == "instructed" for participant in silent) == 2
