from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import select

from studyapp.models import WatchBatch
from studyapp.services.refusal import (
    ConflictError,
    NotTheirsError,
    RefusalError,
    UnacceptableError,
)
from studyapp.services.watch_evidence import length, merged
from studyapp.services.watching import record_watched
from studyapp.services.withdrawing import withdraw
from tests.studyapp.taking_part_steps import Participant

INTERVALS = st.lists(
    st.tuples(st.integers(0, 40), st.integers(0, 40)).map(lambda pair: (min(pair), max(pair)))
)


@given(INTERVALS)
def test_merging_covers_exactly_what_the_intervals_cover(
    intervals: list[tuple[int, int]],
) -> None:
    covered = {second for start, end in intervals for second in range(start, end)}

    union = merged(intervals)

    assert {second for start, end in union for second in range(int(start), int(end))} == covered
    assert length(union) == len(covered)
    assert all(b[0] > a[1] for a, b in itertools.pairwise(union))


def test_playing_the_same_part_twice_is_no_more_than_once(participant: Participant) -> None:
    participant.look()
    participant.clock.advance(seconds=10)

    assert participant.watch((0.0, 1.0), (0.2, 1.0)) == pytest.approx(0.9)
    assert participant.watch((0.0, 1.0), batch=1) == pytest.approx(0.9)
    assert participant.watch((1.0, 1.9), batch=2) == 0


def test_more_than_has_passed_is_refused_and_not_stored(participant: Participant) -> None:
    participant.look()
    participant.clock.advance(seconds=0.5)

    with pytest.raises(UnacceptableError, match="than time has passed"):
        participant.watch((0.0, 2.0))
    assert participant.trial().videos[0].watched.intervals == ()


def test_many_small_reports_cannot_outrun_the_clock_either(participant: Participant) -> None:
    participant.look()
    participant.clock.advance(seconds=0.5)
    participant.watch((0.0, 1.0))

    with pytest.raises(UnacceptableError):
        participant.watch((1.0, 2.0), batch=1)


def test_the_same_report_sent_twice_is_stored_once(participant: Participant) -> None:
    participant.look()
    participant.clock.advance(seconds=5)

    assert participant.watch((0.0, 1.0)) == participant.watch((0.0, 1.0))
    assert participant.trial().videos[0].watched.next_batch == 1


def test_another_report_under_the_same_number_is_not_stored_and_the_answer_shows_it(
    participant: Participant,
) -> None:
    participant.look()
    participant.clock.advance(seconds=5)
    participant.watch((0.0, 1.0))

    assert participant.watch((1.0, 2.0)) == pytest.approx(0.9)
    assert participant.trial().videos[0].watched.intervals == ((0.0, 1.0),)
    assert participant.trial().videos[0].watched.next_batch == 1


def test_what_lies_outside_the_video_does_not_count(participant: Participant) -> None:
    participant.look()
    participant.clock.advance(seconds=60)

    assert participant.watch((1.5, 30.0), (40.0, 50.0)) == pytest.approx(1.4)


def test_a_trial_that_is_not_shown_cannot_be_watched(participant: Participant) -> None:
    following = participant.trial().next_videos[0]
    participant.clock.advance(seconds=60)

    with pytest.raises(ConflictError):
        record_watched(
            participant.database,
            participant.served,
            participant.token,
            following,
            batch=0,
            intervals=[(0.0, 2.0)],
            clock=participant.clock,
        )


def test_somebody_elses_trial_cannot_be_watched(participant: Participant) -> None:
    other = Participant(participant.database, participant.served, participant.clock)
    theirs = other.enrol("another").begin().trial().videos[0].token

    with pytest.raises(NotTheirsError):
        record_watched(
            participant.database,
            participant.served,
            participant.token,
            theirs,
            batch=0,
            intervals=[],
            clock=participant.clock,
        )


def test_nothing_is_stored_of_somebody_who_withdrew(participant: Participant) -> None:
    video_token = participant.trial().videos[0].token
    participant.clock.advance(seconds=5)
    withdraw(participant.database, participant.token, participant.clock)

    with pytest.raises(RefusalError):
        record_watched(
            participant.database,
            participant.served,
            participant.token,
            video_token,
            batch=0,
            intervals=[(0.0, 2.0)],
            clock=participant.clock,
        )
    with participant.database.reading() as session:
        assert session.scalars(select(WatchBatch)).all() == []
