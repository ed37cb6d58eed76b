"""What is computed of study sessions without a database."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest

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


def test_open_places_are_those_required_and_not_held() -> None:
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

    counts = count_places(arms, there)

    assert [(each.done, each.active, each.stale, each.open) for each in counts] == [
        (2, 1, 0, 2),
        (0, 0, 3, 0),
    ]
    assert (total_places(counts).wanted, total_places(counts).remaining) == (7, 5)


@pytest.mark.parametrize(
    ("minutes_ago", "remaining", "began", "expected"),
    [
        ((5, 20, 40, 50, 200, 300), 8, 600, 120),
        ((1, 2, 3), 3, 10, 10),
        ((), 5, None, "nobody has begun yet"),
        ((60, 120), 5, 180, "too few have finished recently"),
        ((12_000, 12_060, 12_120), 5, 18_000, "too few have finished recently"),
        ((60, 60, 60), 0, 180, "all places are done"),
        ((6000, 6060, 6120), 10_000, 18_000, "over a year"),
    ],
)
def test_the_end_is_projected_from_the_current_pace_or_a_reason_is_given(
    minutes_ago: tuple[int, ...], remaining: int, began: int | None, expected: int | str
) -> None:
    finished = [NOON - timedelta(minutes=minutes) for minutes in minutes_ago]
    since = None if began is None else NOON - timedelta(minutes=began)

    projected = forecast(finished, remaining, since, NOON)

    if isinstance(expected, str):
        assert isinstance(projected, str) and expected in projected.lower()
    else:
        assert projected == NOON + timedelta(minutes=expected)


def test_dropouts_are_counted_at_their_last_trial() -> None:
    there = [
        session_progress("done", 10),
        session_progress("active", 4),
        session_progress("stale", 2),
        session_progress("lapsed", 2),
        session_progress("lapsed", 0, started_at=None),
        session_progress("withdrawn"),
    ]

    assert dropouts(there) == (
        Dropout(position=0, left=1, came=5),
        Dropout(position=3, left=2, came=4),
    )


def test_a_check_that_only_careful_raters_fail_is_identified() -> None:
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


def test_a_long_list_is_cut_into_pages_without_loss() -> None:
    long = [session_progress("done", id=number) for number in range(2 * ROWS + 1)]

    pages = list(page_numbers(long))

    assert pages == [1, 2, 3]
    assert [each for number in pages for each in rows_on_page(long, number)] == long
    assert list(page_numbers([])) == [1]
    assert rows_on_page(long, 4) == []


def test_completed_places_are_plotted_with_the_projected_end() -> None:
    began = NOON - timedelta(hours=4)
    finished = [NOON - timedelta(hours=hours) for hours in (2, 3)]

    found = completions(finished, 4, began, NOON + timedelta(hours=4), NOON)

    assert found is not None
    assert (found.since, found.until) == (began, NOON + timedelta(hours=4))
    assert found.done == (
        (0, 0), (0.125, 0), (0.125, 0.25), (0.25, 0.25), (0.25, 0.5), (0.5, 0.5),
    )  # fmt: skip
    assert found.expected == ((0.5, 0.5), (1, 1))
