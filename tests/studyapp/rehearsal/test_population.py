from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from studyapp.rehearsal.simulation.population import (
    default_population,
    ranks,
)
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.rehearsal import Rehearsal


def test_stated_values_replace_defaults(study: PairwiseStudy) -> None:
    stated = Rehearsal.model_validate(
        {
            "careless": 0.2,
            "hasty": 0,
            "segments_differ": 0.1,
            "strength": {"rule_based": 2, "static": {"emotion": -0.25}},
            "own_speech": {"rule_based": {"rhythm": 0.4}},
        }
    )
    people = default_population(study.model_copy(update={"rehearsal": stated}))
    assert people.quality["rule_based"] == {"rhythm": 2, "emotion": 2}
    assert people.quality["static"] == {"rhythm": -1.0, "emotion": -0.25}
    assert people.quality["mismatched"] == default_population(study).quality["mismatched"]
    assert people.belonging["rule_based"] == {"rhythm": 0.4, "emotion": 3.0}
    assert (people.kinds["careless"], people.kinds["hasty"], people.item_sd) == (0.2, 0.0, 0.1)


UTILITIES = st.lists(st.floats(-9, 9), min_size=2, max_size=8)


@given(utilities=UTILITIES, within=st.floats(0, 5))
def test_tied_ranks_skip_no_rank_and_keep_the_order(utilities: list[float], within: float) -> None:
    found = ranks(utilities, tie_within=within)
    assert set(found) == set(range(1, max(found) + 1))
    assert sorted(ranks(utilities)) == list(range(1, len(utilities) + 1))
    for a, b in zip(utilities, found, strict=True):
        for c, d in zip(utilities, found, strict=True):
            assert (a <= c) or b <= d
            assert b != d or abs(a - c) <= within
