from __future__ import annotations

from pathlib import Path

import pytest

from studyapp.session.participation import leave_break
from studyapp.session.shown_trials import expected_seconds, minutes_left
from tests.studyapp.session.conftest import Open
from tests.support.studies.taking_part_steps import Participant


@pytest.fixture
def resting(open_changed: Open) -> Participant:
    """Return a participant of a study of six trials with a break after every two."""
    return open_changed(("[page]\n", "[page]\nbreak_every = 2\n")).enrol().begin()


def test_breaks_come_between_trials_and_never_right_before_the_end(resting: Participant) -> None:
    breaks = []
    while (situation := resting.look()).state != "completed":
        if situation.offered_break is not None:
            breaks.append((situation.offered_break.done, situation.offered_break.position))
            assert situation.trial is None
            resting.do(leave_break, situation.offered_break.position)
        else:
            resting.take_trial()

    assert breaks == [(2, 3), (4, 5)]


def test_a_break_waits_until_it_is_left(resting: Participant) -> None:
    for _ in range(2):
        resting.take_trial()

    for stale in (1, 2, 5):
        resting.do(leave_break, stale)
        assert resting.look().offered_break is not None

    resting.do(leave_break, 3)
    resting.do(leave_break, 3)
    assert resting.trial().position == 3


def test_a_break_takes_no_time_from_the_trial_after_it(resting: Participant) -> None:
    for _ in range(2):
        resting.take_trial()
    left = resting.look().offered_break
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


SHORT, LONG = expected_seconds([10.0], 1), expected_seconds([60.0] * 5, 8)


@pytest.mark.parametrize(
    ("taken", "ahead", "minutes"),
    [
        ([], [SHORT], 1),
        # Before the first answer, the videos tell; then the participant's own pace.
        ([], [LONG] * 8 + [SHORT] * 12, 51),
        ([(50.0, 25.0)], [300.0] * 2, 20),
        ([(30.0, 30.0)] * 2, [300.0] * 4, 20),
        # One long interruption changes nothing.
        ([*[(30.0, 30.0)] * 2, (3600.0, 30.0)], [300.0] * 4, 20),
    ],
)
def test_the_time_left_is_what_videos_and_the_pace_so_far_tell(
    taken: list[tuple[float, float]], ahead: list[float], minutes: int
) -> None:
    assert minutes_left(taken, ahead) == minutes
