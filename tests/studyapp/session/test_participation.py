from __future__ import annotations

from dataclasses import replace

import pytest

from studyapp.session.participation import look
from studyapp.session.refusal import UnknownAddressError
from studyapp.session.video_access import content_of
from tests.studyapp.taking_part_steps import Participant


def test_an_unknown_address_is_refused(participant: Participant) -> None:
    with pytest.raises(UnknownAddressError):
        look(participant.database, participant.served, "nobody", participant.clock)


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

    participant.withdraw()
    assert content_of(participant.database, second.videos[0].token) is None


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
