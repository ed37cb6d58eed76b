from __future__ import annotations

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from studyapp.study.design.order import (
    number_trials,
    scatter,
)
from studyapp.study.design.trial import Kind, PlannedTrial
from tests.support.studies.made_study import make_segments

SEEDS = st.integers(0, 2**32 - 1)


def trial(kind: Kind, part: str = "") -> PlannedTrial:
    (segment,) = make_segments(["anger"])
    return PlannedTrial(position=0, kind=kind, part=part, segment=segment, videos=())


@given(st.integers(0, 9), st.integers(1, 9), SEEDS, st.booleans())
def test_extra_trials_leave_the_others_in_order_and_apart_where_there_is_room(
    extra: int, others: int, seed: int, may_lead: bool
) -> None:
    known = number_trials([trial("main")] * others)
    merged = scatter(
        [trial("catch")] * extra, known, np.random.default_rng(seed), may_lead=may_lead
    )

    assert [t for t in merged if t.kind == "main"] == list(known)
    assert len(merged) == extra + others
    assert may_lead or merged[0].kind == "main"
    if extra <= others:
        assert all("main" in (a.kind, b.kind) for a, b in itertools.pairwise(merged))
