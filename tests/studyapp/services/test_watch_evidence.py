from __future__ import annotations

import itertools
from datetime import UTC, datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studyapp.models import TrialStimulus, Video, WatchBatch
from studyapp.services.watch_evidence import (
    length,
    merged,
    sum_with_restarts,
    watched_so_far,
)

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


def silent_video(speech: str | None) -> Video:
    """Return a video of which two seconds were played without sound."""
    shown = TrialStimulus(number=1, condition="a", segment="s", speech=speech)
    batch = WatchBatch(
        batch=0,
        intervals=[[0.0, 2.0]],
        rate=1.0,
        hidden_seconds=0.0,
        silent_seconds=2.0,
        received_at=datetime(2026, 5, 4, tzinfo=UTC),
    )
    return Video(number=1, token="v", duration=2.0, stimuli=[shown], watch_batches=[batch])  # noqa: S106


@pytest.mark.parametrize(("speech", "missing"), [(None, 0.0), ("s", 2.0)])
def test_silence_counts_only_where_there_is_nothing_to_hear(
    speech: str | None, missing: float
) -> None:
    assert watched_so_far(silent_video(speech), 1.0).missing == missing


@pytest.mark.parametrize(
    ("totals", "total"),
    [
        ([], None),
        ([None, None], None),
        ([10, 40, 60], 60),
        ([10, None, 60], 60),
        ([10, 60, 5, 20], 80),
        ([0, 0], 0),
    ],
)
def test_a_counter_that_begins_anew_with_each_page_is_summed(
    totals: list[int | None], total: int | None
) -> None:
    assert sum_with_restarts(totals) == total
