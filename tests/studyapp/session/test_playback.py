import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import select

from studyapp.database.tables.trial import Trial, WatchRecord
from studyapp.session.refusal import (
    ConflictError,
    RefusalError,
    TooMuchWatchedError,
    UnacceptableError,
)
from studyapp.session.watch_evidence import (
    MAX_INTERVALS,
    NOTHING_PLAYED,
    REMEMBERED_REPORTS,
    Playback,
    Report,
    Watched,
    add_report,
    merge_intervals,
    total_seconds,
)
from tests.support.studies.stored import found_in
from tests.support.studies.taking_part_steps import Participant

POINTS = st.integers(0, 40)
INTERVALS = st.lists(st.tuples(POINTS, POINTS).map(lambda pair: (min(pair), max(pair))))


@given(INTERVALS)
def test_merged_intervals_cover_exactly_their_union(intervals: list[tuple[int, int]]) -> None:
    covered = {second for start, end in intervals for second in range(start, end)}

    union = merge_intervals(intervals)

    assert {second for start, end in union for second in range(int(start), int(end))} == covered
    assert total_seconds(union) == len(covered)
    assert all(b[0] > a[1] for a, b in itertools.pairwise(union))


@pytest.mark.parametrize(("soundless", "watched"), [(True, 2.0), (False, 0.0)])
def test_muted_playback_counts_only_for_silent_videos(soundless: bool, watched: float) -> None:
    report = Report(batch=0, intervals=((0.0, 2.0),), silent_seconds=2.0)

    record = add_report(NOTHING_PLAYED, report, soundless=soundless)

    assert total_seconds(record.intervals) == watched


def report_again(participant: Participant, *intervals: tuple[float, float]) -> Watched:
    """Send the first report of the present video once more."""
    return participant.report(participant.trial().videos[0].token, *intervals)


def record_of(participant: Participant) -> WatchRecord:
    (record,) = found_in(participant.database, select(WatchRecord))
    return record


@pytest.fixture
def watcher(participant: Participant) -> Participant:
    """Return a participant who has had the first trial open for a long time."""
    participant.look()
    participant.clock.advance(seconds=1000)
    return participant


@pytest.mark.parametrize(
    "playback",
    [Playback(rate=1.5), Playback(hidden_seconds=2.0), Playback(silent_seconds=2.0)],
    ids=["fast", "hidden", "silent"],
)
def test_fast_hidden_or_silent_playing_is_stored_but_does_not_count(
    watcher: Participant, playback: Playback
) -> None:
    assert watcher.watch((0.0, 2.0), playback=playback) == pytest.approx(1.9)

    with pytest.raises(UnacceptableError, match="About 2 s"):
        watcher.answer(watcher.trial().token)
    assert (record_of(watcher).intervals, record_of(watcher).played_seconds) == ([], 2.0)
    assert watcher.watch((0.0, 2.0), batch=1) == 0


def test_playing_a_little_faster_or_slower_within_the_video_counts(watcher: Participant) -> None:
    assert watcher.watch((1.5, 30.0), (40.0, 50.0)) == pytest.approx(1.4)
    fast, slow = Playback(rate=1.04), Playback(rate=0.5)
    assert watcher.watch((0.0, 1.0), batch=1, playback=fast) == pytest.approx(0.4)
    assert watcher.watch((1.0, 1.5), batch=2, playback=slow) == 0


@pytest.mark.parametrize(
    "playback",
    [
        Playback(),
        Playback(hidden_seconds=50.0),
        Playback(silent_seconds=50.0),
        Playback(stalled_seconds=50.0),
    ],
)
def test_reports_cannot_exceed_the_elapsed_time(
    participant: Participant, playback: Playback
) -> None:
    participant.look()
    participant.clock.advance(seconds=0.5)
    participant.watch((0.0, 1.0))

    with pytest.raises(TooMuchWatchedError, match="than there was time for"):
        participant.watch((1.0, 2.0), batch=1, playback=playback)
    assert participant.trial().videos[0].watched.intervals == ((0.0, 1.0),)


def test_stalls_and_frames_are_summed_as_measured(watcher: Participant) -> None:
    watcher.watch((0.0, 1.0), playback=Playback(stalls=2, stalled_seconds=7.5, frames=50))
    watcher.watch((1.0, 2.0), batch=1)
    measured = Playback(stalls=1, stalled_seconds=0.5, frames=20, dropped_frames=3)
    watcher.watch((0.0, 1.0), batch=2, playback=measured)

    record = record_of(watcher)
    assert (record.stalls, record.stalled_seconds) == (3, 8.0)
    assert (record.frames, record.dropped_frames) == (70, 3)


def test_reports_and_answers_are_accepted_after_the_clock_was_set_back(
    participant: Participant,
) -> None:
    trial = participant.trial()
    participant.clock.advance(seconds=5)
    participant.clock.advance(hours=-1)

    assert participant.watch((0.0, 2.0)) == 0
    participant.answer(trial.token)

    (first,) = found_in(participant.database, select(Trial).where(Trial.position == 1))
    assert first.answered_at is not None
    assert first.seconds is None
    participant.trial()
    participant.clock.advance(seconds=1)
    with pytest.raises(TooMuchWatchedError):
        participant.watch((0.0, 2.0), playback=Playback(hidden_seconds=5.0))


def test_a_report_number_counts_once_and_is_acknowledged_if_stored(watcher: Participant) -> None:
    watcher.watch((0.0, 1.0))
    assert watcher.watch((1.0, 2.0)) == pytest.approx(0.9)
    assert not report_again(watcher, (1.0, 2.0)).stored
    assert report_again(watcher, (0.0, 1.0)).stored
    assert watcher.trial().videos[0].watched.intervals == ((0.0, 1.0),)
    assert watcher.trial().videos[0].watched.next_batch == 1

    for batch in range(1, REMEMBERED_REPORTS + 1):
        watcher.watch((0.0, 1.0), batch=batch)

    # The first one is no longer remembered; its number stays used up.
    assert not report_again(watcher, (0.0, 1.0)).stored
    assert record_of(watcher).played_seconds == REMEMBERED_REPORTS + 1


def test_a_video_watched_in_too_many_parts_must_be_replayed(watcher: Participant) -> None:
    spans = [(start / 200, start / 200 + 0.001) for start in range(MAX_INTERVALS + 1)]
    watcher.watch(*spans[:-1])

    with pytest.raises(UnacceptableError, match="too many small parts"):
        watcher.watch(spans[-1], batch=1)

    assert watcher.watch((0.0, 2.0), batch=1) == 0


def test_reports_of_hidden_trials_or_after_withdrawal_are_not_stored(watcher: Participant) -> None:
    shown = watcher.trial()
    with pytest.raises(ConflictError):
        watcher.report(shown.next_videos[0], (0.0, 2.0))
    watcher.withdraw()
    with pytest.raises(RefusalError):
        watcher.report(shown.videos[0].token, (0.0, 2.0))
    assert found_in(watcher.database, select(WatchRecord)) == []
