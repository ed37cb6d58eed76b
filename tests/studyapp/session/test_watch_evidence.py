from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studyapp.session.watch_evidence import (
    NOTHING_PLAYED,
    Report,
    add_report,
    merge_intervals,
    total_seconds,
)

POINTS = st.integers(0, 40)
INTERVALS = st.lists(st.tuples(POINTS, POINTS).map(lambda pair: (min(pair), max(pair))))


@given(INTERVALS)
def test_merging_covers_exactly_what_the_intervals_cover(intervals: list[tuple[int, int]]) -> None:
    covered = {second for start, end in intervals for second in range(start, end)}

    union = merge_intervals(intervals)

    assert {second for start, end in union for second in range(int(start), int(end))} == covered
    assert total_seconds(union) == len(covered)
    assert all(b[0] > a[1] for a, b in itertools.pairwise(union))


@pytest.mark.parametrize(("soundless", "watched"), [(True, 2.0), (False, 0.0)])
def test_silence_counts_only_where_there_is_nothing_to_hear(
    soundless: bool, watched: float
) -> None:
    report = Report(batch=0, intervals=((0.0, 2.0),), silent_seconds=2.0)

    record = add_report(NOTHING_PLAYED, report, soundless=soundless)

    assert total_seconds(record.intervals) == watched
