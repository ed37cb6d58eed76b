from __future__ import annotations

import itertools
from collections import Counter

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from studyapp.study.design.order import (
    drawn_segments,
    numbered,
    pair_trials,
    scattered,
)
from studyapp.study.design.trial import Kind, PlannedTrial, Stimulus
from tests.studyapp.made_study import make_segments

SEEDS = st.integers(0, 2**32 - 1)


def trial(kind: Kind, part: str = "") -> PlannedTrial:
    (segment,) = make_segments(["anger"])
    return PlannedTrial(position=0, kind=kind, part=part, segment=segment, videos=())


@given(st.integers(0, 9), st.integers(1, 9), SEEDS, st.booleans())
def test_extra_trials_leave_the_others_in_order_and_apart_where_there_is_room(
    extra: int, others: int, seed: int, may_lead: bool
) -> None:
    known = numbered([trial("main")] * others)
    merged = scattered(
        [trial("catch")] * extra, known, np.random.default_rng(seed), may_lead=may_lead
    )

    assert [t for t in merged if t.kind == "main"] == list(known)
    assert len(merged) == extra + others
    assert may_lead or merged[0].kind == "main"
    if extra <= others:
        assert all("main" in (a.kind, b.kind) for a, b in itertools.pairwise(merged))


@given(st.integers(1, 6), st.integers(0, 20), SEEDS)
def test_no_segment_is_drawn_again_before_all_others(segments: int, count: int, seed: int) -> None:
    drawn = drawn_segments(make_segments(["anger"] * segments), count, np.random.default_rng(seed))

    counts = Counter(segment.name for segment in drawn)
    assert len(drawn) == count
    assert max(counts.values(), default=0) - min(counts.values(), default=0) <= 1


@given(SEEDS, st.booleans())
def test_a_pair_is_one_video_or_two_and_the_first_is_a_in_half_of_them(
    seed: int, composed: bool
) -> None:
    segments = make_segments(["anger"] * 8)
    shown = [(s, Stimulus.own("ours", s.name), Stimulus.own("theirs", s.name)) for s in segments]

    trials = pair_trials("main", shown, np.random.default_rng(seed), composed=composed)

    assert [len(t.videos) for t in trials] == [1 if composed else 2] * 8
    assert sum(t.conditions[0] == "ours" for t in trials) == 4
    assert [t.segment for t in trials] == list(segments)
