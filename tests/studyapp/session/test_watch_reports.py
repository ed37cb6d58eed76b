from __future__ import annotations

import pytest
from sqlalchemy import select

from studyapp.database.tables import Trial, WatchRecord
from studyapp.session.refusal import (
    ConflictError,
    RefusalError,
    TooMuchWatchedError,
    UnacceptableError,
)
from studyapp.session.watch_evidence import MAX_INTERVALS, REMEMBERED_REPORTS, Playback, Watched
from tests.support.studies.taking_part_steps import Participant

UNCOUNTED = {
    "fast": Playback(rate=1.5),
    "hidden": Playback(hidden_seconds=2.0),
    "silent": Playback(silent_seconds=2.0),
}


def report_again(participant: Participant, *intervals: tuple[float, float]) -> Watched:
    """Send the first report of the present video once more."""
    return participant.report(participant.trial().videos[0].token, *intervals)


@pytest.mark.parametrize("how", UNCOUNTED)
def test_what_was_played_fast_hidden_or_silent_is_kept_but_does_not_count(
    participant: Participant, how: str
) -> None:
    first = participant.trial().token
    participant.clock.advance(seconds=10)

    assert participant.watch((0.0, 2.0), playback=UNCOUNTED[how]) == pytest.approx(1.9)

    with pytest.raises(UnacceptableError, match="About 2 s"):
        participant.answer(first)
    with participant.database.reading() as session:
        (record,) = session.scalars(select(WatchRecord))
        assert (record.intervals, record.played_seconds) == ([], 2.0)
    assert participant.watch((0.0, 2.0), batch=1) == 0


def test_what_is_played_a_little_faster_or_slower_and_within_the_video_counts(
    participant: Participant,
) -> None:
    participant.look()
    participant.clock.advance(seconds=60)

    assert participant.watch((1.5, 30.0), (40.0, 50.0)) == pytest.approx(1.4)
    fast, slow = Playback(rate=1.04), Playback(rate=0.5)
    assert participant.watch((0.0, 1.0), batch=1, playback=fast) == pytest.approx(0.4)
    assert participant.watch((1.0, 1.5), batch=2, playback=slow) == 0


@pytest.mark.parametrize(
    "playback",
    [
        Playback(),
        Playback(hidden_seconds=50.0),
        Playback(silent_seconds=50.0),
        Playback(stalled_seconds=50.0),
    ],
)
def test_more_than_has_passed_is_refused_and_not_stored_however_small_the_reports(
    participant: Participant, playback: Playback
) -> None:
    participant.look()
    participant.clock.advance(seconds=0.5)
    participant.watch((0.0, 1.0))

    with pytest.raises(TooMuchWatchedError, match="than there was time for"):
        participant.watch((1.0, 2.0), batch=1, playback=playback)
    assert participant.trial().videos[0].watched.intervals == ((0.0, 1.0),)


def test_stalls_and_pictures_are_added_up_as_they_were_measured(participant: Participant) -> None:
    participant.look()
    participant.clock.advance(seconds=20)

    participant.watch((0.0, 1.0), playback=Playback(stalls=2, stalled_seconds=7.5, frames=50))
    participant.watch((1.0, 2.0), batch=1)
    measured = Playback(stalls=1, stalled_seconds=0.5, frames=20, dropped_frames=3)
    participant.watch((0.0, 1.0), batch=2, playback=measured)

    with participant.database.reading() as session:
        (record,) = session.scalars(select(WatchRecord))
        assert (record.stalls, record.stalled_seconds) == (3, 8.0)
        assert (record.frames, record.dropped_frames) == (70, 3)


def test_honest_reports_and_answers_are_taken_after_the_clock_went_back_an_hour(
    participant: Participant,
) -> None:
    trial = participant.trial()
    participant.clock.advance(seconds=5)
    participant.clock.advance(hours=-1)

    assert participant.watch((0.0, 2.0)) == 0
    participant.answer(trial.token)

    with participant.database.reading() as session:
        first, second = session.scalars(select(Trial).order_by(Trial.position).limit(2))
        assert first.answered_at is not None
        assert first.seconds is None
    second_trial = participant.trial()
    participant.clock.advance(seconds=1)
    with pytest.raises(TooMuchWatchedError):
        participant.watch((0.0, 2.5), (0.0, 2.0), playback=Playback(hidden_seconds=5.0))
    assert second_trial.position == second.position


def test_another_report_under_the_same_number_is_not_stored_and_the_answer_shows_it(
    participant: Participant,
) -> None:
    participant.look()
    participant.clock.advance(seconds=5)
    participant.watch((0.0, 1.0))

    assert participant.watch((1.0, 2.0)) == pytest.approx(0.9)
    assert not report_again(participant, (1.0, 2.0)).stored
    assert report_again(participant, (0.0, 1.0)).stored
    assert participant.trial().videos[0].watched.intervals == ((0.0, 1.0),)
    assert participant.trial().videos[0].watched.next_batch == 1


def test_a_report_among_the_latest_is_known_again_and_an_older_number_is_used_up(
    participant: Participant,
) -> None:
    participant.look()
    participant.clock.advance(seconds=100)
    participant.watch((0.0, 1.0))
    assert report_again(participant, (0.0, 1.0)).stored

    for batch in range(1, REMEMBERED_REPORTS + 1):
        participant.watch((0.0, 1.0), batch=batch)

    assert not report_again(participant, (0.0, 1.0)).stored
    with participant.database.reading() as session:
        (record,) = session.scalars(select(WatchRecord))
        assert record.played_seconds == REMEMBERED_REPORTS + 1


def test_a_video_in_too_many_parts_has_to_be_played_from_its_start(
    participant: Participant,
) -> None:
    participant.look()
    participant.clock.advance(seconds=1000)
    spans = [(start / 200, start / 200 + 0.001) for start in range(MAX_INTERVALS + 1)]
    participant.watch(*spans[:-1])

    with pytest.raises(UnacceptableError, match="too many small parts"):
        participant.watch(spans[-1], batch=1)

    assert participant.watch((0.0, 2.0), batch=1) == 0


def test_a_trial_that_is_not_shown_cannot_be_watched(participant: Participant) -> None:
    following = participant.trial().next_videos[0]
    participant.clock.advance(seconds=60)

    with pytest.raises(ConflictError):
        participant.report(following, (0.0, 2.0))


def test_nothing_is_stored_of_somebody_who_withdrew(participant: Participant) -> None:
    video_token = participant.trial().videos[0].token
    participant.clock.advance(seconds=5)
    participant.withdraw()

    with pytest.raises(RefusalError):
        participant.report(video_token, (0.0, 2.0))
    with participant.database.reading() as session:
        assert session.scalars(select(WatchRecord)).all() == []
