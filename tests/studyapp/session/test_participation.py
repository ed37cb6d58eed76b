from __future__ import annotations

from dataclasses import replace

import pytest

from studyapp.session.arrivals import Arrival
from studyapp.session.ending import withdraw
from studyapp.session.enrolment import enrol
from studyapp.session.participation import look
from studyapp.session.places import release_stale
from studyapp.session.refusal import ConflictError, UnknownAddressError
from studyapp.session.video_access import content_of
from tests.studyapp.exported import responses_table
from tests.studyapp.read_once import read_once
from tests.studyapp.taking_part_steps import Participant


def fill(participant: Participant, places: int) -> None:
    for number in range(places):
        enrol(
            participant.database,
            participant.served,
            Arrival(visit=f"filler {number}"),
            participant.clock,
        )


def test_looking_again_shows_the_same_trial(participant: Participant) -> None:
    assert participant.trial() == participant.trial()


def test_instructions_come_before_the_first_trial(participant: Participant) -> None:
    other = Participant(participant.database, participant.served, participant.clock).enrol("new")

    assert other.look().state == "instructed"
    assert other.look().trial is None


def test_an_unknown_address_is_refused(participant: Participant) -> None:
    with pytest.raises(UnknownAddressError):
        look(participant.database, participant.served, "nobody", participant.clock)


def lapse(participant: Participant) -> None:
    """Let the participant fall silent for so long that the next arrival releases the place."""
    participant.take_trial()
    participant.clock.advance(minutes=46)


def test_who_comes_back_to_a_place_still_free_goes_on_where_they_were(
    participant: Participant,
) -> None:
    lapse(participant)
    with participant.database.writing() as session:
        release_stale(session, participant.served, participant.clock.now())

    situation = participant.look()

    assert situation.state == "started"
    assert situation.trial is not None
    assert situation.trial.position == 2


def test_who_comes_back_to_a_place_given_on_is_not_asked_to_go_on(
    participant: Participant,
) -> None:
    lapse(participant)
    fill(participant, 1)

    assert participant.look().state == "lapsed"
    participant.clock.advance(minutes=46)
    fill(participant, 2)
    assert participant.look().state == "lapsed"
    assert len(read_once(participant.database, responses_table)) == 2


def test_withdrawing_ends_it_and_opens_the_place(participant: Participant) -> None:
    participant.take_trial()
    fill(participant, 3)

    withdraw(participant.database, participant.token, participant.clock)

    assert participant.look().state == "withdrawn"
    enrol(participant.database, participant.served, Arrival(visit="new"), participant.clock)


def test_who_has_finished_can_no_longer_withdraw(participant: Participant) -> None:
    participant.take_all()

    with pytest.raises(ConflictError, match="already finished"):
        withdraw(participant.database, participant.token, participant.clock)


def test_only_the_present_and_the_following_video_are_given_out(
    participant: Participant,
) -> None:
    first = participant.trial()
    assert content_of(participant.database, first.videos[0].token) is not None
    assert content_of(participant.database, first.next_videos[0]) is not None

    participant.take_trial()
    second = participant.trial()
    assert content_of(participant.database, first.videos[0].token) is None
    assert content_of(participant.database, second.videos[0].token) is not None

    withdraw(participant.database, participant.token, participant.clock)
    assert content_of(participant.database, second.videos[0].token) is None


def test_a_video_two_trials_ahead_is_not_given_out(participant: Participant) -> None:
    participant.take_trial()
    ahead = participant.trial().next_videos[0]
    other = Participant(participant.database, participant.served, participant.clock)
    other.enrol("other").begin().take_trial()
    theirs = other.trial().next_videos[0]

    assert content_of(participant.database, ahead) is not None
    assert content_of(participant.database, theirs) is not None
    assert content_of(participant.database, "no token") is None


def test_the_time_left_weighs_how_much_each_page_asks(participant: Participant) -> None:
    before = participant.trial().minutes_left
    study = participant.served.study
    many = [study.questions[0].model_copy(update={"name": f"question_{n}"}) for n in range(12)]
    served = replace(participant.served, study=study.model_copy(update={"questions": many}))

    trial = look(participant.database, served, participant.token, participant.clock).trial

    assert trial is not None
    assert (before, trial.minutes_left) == (2, 6)  # of six trials with one video of two seconds


def test_the_time_left_follows_the_participants_own_pace(participant: Participant) -> None:
    participant.trial()
    participant.clock.advance(minutes=3)
    participant.take_trial()

    assert participant.trial().minutes_left == 16
