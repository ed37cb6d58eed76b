"""What is computed of study sessions without a database."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studyapp.monitoring.answered_trials import AnsweredTrial, progress, sides
from studyapp.monitoring.counts import (
    Dropout,
    completions,
    count_places,
    dropouts,
    forecast,
    total_places,
)
from studyapp.monitoring.data_quality import Check, checked_items, failed_by_session
from studyapp.monitoring.study_sessions import (
    ROWS,
    ListedSession,
    SessionProgress,
    Standing,
    page_numbers,
    rows_on_page,
)
from studyapp.study.design.trial import Arm

NOON = datetime(2026, 5, 4, 12, tzinfo=UTC)


def session_progress(standing: Standing, settled: int = 0, **changes: Any) -> SessionProgress:
    """Return a study session of ten trials that began at noon."""
    values: dict[str, Any] = {
        "id": 1,
        "arm": "a-b",
        "present": True,
        "standing": standing,
        "consented_at": NOON,
        "started_at": NOON,
        "last_active_at": NOON,
        "completed_at": NOON + timedelta(minutes=10) if standing == "done" else None,
        "trials": 10,
        "settled": settled,
    }
    return SessionProgress(**(values | changes))


def test_places_are_open_that_are_wanted_and_held_by_nobody() -> None:
    arms = [
        Arm(name=name, conditions=("a", "b"), places=places)
        for name, places in (("x", 5), ("y", 2))
    ]
    there = [
        *(session_progress("done", arm="x") for _ in range(2)),
        session_progress("active", arm="x"),
        session_progress("lapsed", arm="x"),
        session_progress("done", arm="x", present=False),
        *(session_progress("stale", arm="y") for _ in range(3)),
    ]

    x, y = count_places(arms, there)
    together = total_places([x, y])

    assert (x.done, x.active, x.stale, x.open, x.wanted) == (2, 1, 0, 2, 5)
    assert (y.done, y.active, y.stale, y.open, y.wanted) == (0, 0, 3, 0, 2)
    assert (together.done, together.wanted, together.remaining) == (2, 7, 5)


@pytest.mark.parametrize(
    ("minutes_ago", "remaining", "began_minutes_ago", "done_in"),
    [((5, 20, 40, 50, 200, 300), 8, 600, 120), ((1, 2, 3), 3, 10, 10)],
)
def test_the_study_is_done_when_as_many_have_come_as_lately_or_since_it_began(
    minutes_ago: tuple[int, ...], remaining: int, began_minutes_ago: int, done_in: int
) -> None:
    finished = [NOON - timedelta(minutes=minutes) for minutes in minutes_ago]

    found = forecast(finished, remaining, NOON - timedelta(minutes=began_minutes_ago), NOON)

    assert (found.at, found.reason) == (NOON + timedelta(minutes=done_in), "")


@pytest.mark.parametrize(
    ("hours_ago", "remaining", "began_hours_ago", "reason"),
    [
        ([], 5, None, "nobody has begun yet"),
        ([1, 2], 5, 3, "too few have finished recently"),
        ([200, 201, 202], 5, 300, "too few have finished recently"),
        ([1, 1, 1], 0, 3, "all places are done"),
        ([100, 101, 102], 10_000, 300, "more than a year"),
    ],
)
def test_where_nobody_can_tell_when_it_is_done_the_reason_is_said(
    hours_ago: list[int], remaining: int, began_hours_ago: int | None, reason: str
) -> None:
    finished = [NOON - timedelta(hours=hours) for hours in hours_ago]
    began = None if began_hours_ago is None else NOON - timedelta(hours=began_hours_ago)

    found = forecast(finished, remaining, began, NOON)

    assert found.at is None
    assert reason in found.reason


def test_who_left_is_counted_at_the_trial_they_stood_at() -> None:
    there = [
        session_progress("done", 10),
        session_progress("active", 4),
        session_progress("stale", 2),
        session_progress("lapsed", 2),
        session_progress("lapsed", 0, started_at=None),
        session_progress("withdrawn"),
    ]

    found = dropouts(there)

    assert found.by_trial == (
        Dropout(position=0, left=1, came=5),
        Dropout(position=3, left=2, came=4),
    )
    assert (found.left, found.withdrawn, found.came) == (3, 1, 6)


def test_only_analysed_trials_of_counted_study_sessions_are_progress() -> None:
    trials = [
        AnsweredTrial(1, 1, "practice", "anger", 9.0),
        AnsweredTrial(1, 2, "main", "anger", 9.0),
        AnsweredTrial(1, 3, "repeat", "anger", 9.0),
        AnsweredTrial(1, 4, "catch", "anger", 9.0),
        AnsweredTrial(2, 1, "main", "", 9.0),
        AnsweredTrial(3, 1, "main", "anger", 9.0),
    ]

    found = progress(trials, {1: "x", 2: "y"})

    assert found.emotions == ("", "anger")
    assert (found.of("x", "anger"), found.of("y", ""), found.of("y", "anger")) == (2, 1, 0)
    assert (found.of_emotion("anger"), found.largest) == (2, 2)
    assert progress([], {}).largest == 0


def test_a_check_that_only_careful_raters_fail_is_told_apart() -> None:
    found = [
        *(Check(person, "catch", "hard", failed=True) for person in range(3)),
        *(Check(person, "catch", "easy", failed=False) for person in range(3)),
        Check(3, "catch", "hard", failed=True),
        Check(3, "catch", "easy", failed=True),
        Check(3, "attention", "read", failed=False),
        Check(4, "catch", "easy", failed=True, answered=False),
    ]

    hard, easy, read = checked_items(found)

    assert (hard.item, hard.failed, hard.answered) == ("hard", 4, 4)
    assert (hard.careful_failed, hard.careful) == (3, 3)
    assert (easy.failed, easy.careful_failed, easy.careful) == (1, 0, 0)
    assert (read.kind, read.careful) == ("attention", 0)
    assert failed_by_session(found, "catch") == {0: 1, 1: 1, 2: 1, 3: 2, 4: 1}


@pytest.mark.parametrize(
    ("left", "right", "balanced"),
    [(50, 50, True), (64, 36, True), (66, 34, False), (0, 0, True), (3, 0, True), (20, 0, False)],
)
def test_sides_are_balanced_as_far_as_chance_goes(left: int, right: int, balanced: bool) -> None:
    (found,) = sides({("ours", 1): left, ("ours", 2): right}, {"ours": "Ours (full)"})

    assert (found.left, found.right) == (left, right)
    assert found.balanced is balanced


def test_a_long_list_is_cut_into_pages_without_loss() -> None:
    long = [
        ListedSession(progress=session_progress("done", id=number), failures=None)
        for number in range(2 * ROWS + 1)
    ]

    pages = list(page_numbers(long))

    assert pages == [1, 2, 3]
    assert [each for number in pages for each in rows_on_page(long, number)] == long
    assert list(page_numbers([])) == [1]
    assert rows_on_page(long, 4) == []


def test_places_done_are_a_staircase_that_goes_on_to_the_projected_end() -> None:
    began = NOON - timedelta(hours=4)
    finished = [NOON - timedelta(hours=hours) for hours in (2, 3)]

    found = completions(finished, 4, began, NOON + timedelta(hours=4), NOON)

    assert found is not None
    assert (found.since, found.until) == (began, NOON + timedelta(hours=4))
    assert found.done == (
        (0, 0), (0.125, 0), (0.125, 0.25), (0.25, 0.25), (0.25, 0.5), (0.5, 0.5),
    )  # fmt: skip
    assert found.expected == ((0.5, 0.5), (1, 1))


@given(st.lists(st.integers(0, 10**7), min_size=1, max_size=500))
def test_a_staircase_only_rises_and_stays_short(seconds: list[int]) -> None:
    finished = [NOON + timedelta(seconds=each) for each in seconds]

    found = completions(finished, len(finished), NOON, None, NOON + timedelta(days=365))

    assert found is not None
    assert list(found.done) == sorted(found.done)
    assert len(found.done) < 500
    assert found.done[-1] == (1, 1)
