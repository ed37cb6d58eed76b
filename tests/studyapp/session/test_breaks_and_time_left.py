from __future__ import annotations

from pathlib import Path

import pytest

from studyapp.session.participation import leave_break
from studyapp.session.shown_trials import expected_seconds, minutes_left
from tests.studyapp.session.conftest import Open
from tests.studyapp.taking_part_steps import Participant


@pytest.fixture
def resting(open_changed: Open) -> Participant:
    """Return a participant of a study of six trials with a break after every two."""
    return open_changed(("[page]\n", "[page]\nbreak_every = 2\n")).enrol().begin()


def test_breaks_come_between_trials_and_never_right_before_the_end(resting: Participant) -> None:
    breaks = []
    while (situation := resting.look()).state != "completed":
        if situation.rest is not None:
            breaks.append((situation.rest.done, situation.rest.position))
            assert situation.trial is None
            resting.do(leave_break, situation.rest.position)
        else:
            resting.take_trial()

    assert breaks == [(2, 3), (4, 5)]


def test_a_break_waits_until_it_is_left(resting: Participant) -> None:
    for _ in range(2):
        resting.take_trial()

    for stale in (1, 2, 5):
        resting.do(leave_break, stale)
        assert resting.look().rest is not None

    resting.do(leave_break, 3)
    resting.do(leave_break, 3)
    assert resting.trial().position == 3


def test_a_break_takes_no_time_from_the_trial_after_it(resting: Participant) -> None:
    for _ in range(2):
        resting.take_trial()
    left = resting.look().rest
    assert left is not None

    resting.clock.advance(minutes=30)
    resting.do(leave_break, 3)
    shown = resting.trial()

    assert shown.minutes_left == left.minutes_left
    resting.take_trial()
    resting.clock.advance(minutes=30)
    assert resting.trial().minutes_left == left.minutes_left


def test_a_trial_that_was_shown_is_not_interrupted_by_a_new_rule(
    participant: Participant, tiny_study: Path
) -> None:
    participant.take_trial()
    participant.trial()
    page = participant.served.study.page.model_copy(update={"break_every": 1})
    object.__setattr__(participant.served.study, "page", page)

    assert participant.trial().position == 2


def test_the_time_left_follows_the_participants_own_pace(participant: Participant) -> None:
    participant.trial()
    participant.clock.advance(minutes=3)
    participant.take_trial()

    assert participant.trial().minutes_left == 16


def test_many_answers_to_a_page_take_longer_than_its_videos() -> None:
    assert expected_seconds([10.0], 6) - expected_seconds([10.0], 2) == 16.0
    assert expected_seconds([10.0], 1) == expected_seconds([10.0], 0)


def test_before_the_first_answer_the_videos_tell() -> None:
    short, long = expected_seconds([10.0], 1), expected_seconds([60.0] * 5, 8)

    assert minutes_left([], [short]) == 1
    assert minutes_left([], [long] * 8 + [short] * 12) == 51


def test_the_participants_own_pace_is_carried_over_to_longer_trials() -> None:
    assert minutes_left([(50.0, 25.0)], [300.0] * 2) == 20


def test_one_long_interruption_changes_nothing() -> None:
    steady = [(30.0, 30.0), (30.0, 30.0)]

    assert minutes_left([*steady, (3600.0, 30.0)], [30.0] * 4) == minutes_left(steady, [30.0] * 4)
