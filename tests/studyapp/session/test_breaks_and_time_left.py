from __future__ import annotations

from pathlib import Path

import pytest

from studyapp.session.participation import leave_break
from studyapp.session.trials import minutes_left
from tests.studyapp.session.conftest import Open
from tests.support.studies.taking_part_steps import Participant


@pytest.fixture
def resting(open_changed: Open) -> Participant:
    """Return a participant of a study of six trials with a break after every two."""
    return open_changed(("[page]\n", "[page]\nbreak_every = 2\n")).enrol().begin()


def test_breaks_come_between_trials_but_not_right_before_the_end(
    resting: Participant,
) -> None:
    breaks = []
    while (situation := resting.look()).state != "completed":
        if (offered := situation.offered_break) is None:
            resting.take_trial()
            continue
        breaks.append(offered.position)
        assert situation.trial is None
        for stale in (1, 2, 6):
            resting.do(leave_break, stale)
            assert resting.look().offered_break == offered
        for _ in range(2):
            resting.do(leave_break, offered.position)
        assert resting.trial().position == offered.position

    assert breaks == [3, 5]


def test_a_break_does_not_count_towards_the_next_trials_time(resting: Participant) -> None:
    for _ in range(2):
        resting.take_trial()
    offered = resting.look().offered_break
    assert offered is not None

    resting.clock.advance(minutes=30)
    resting.do(leave_break, 3)

    assert resting.trial().minutes_left == offered.minutes_left


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


@pytest.mark.parametrize(
    ("taken", "ahead", "minutes"),
    [
        ([], [10.0], 1),
        ([(50.0, 25.0)], [300.0] * 2, 20),
        # One long interruption changes nothing.
        ([*[(30.0, 30.0)] * 2, (3600.0, 30.0)], [300.0] * 4, 20),
    ],
)
def test_the_pace_is_the_median_of_the_trials_so_far(
    taken: list[tuple[float, float]], ahead: list[float], minutes: int
) -> None:
    assert minutes_left(taken, ahead) == minutes
