from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.stats.rankings.friedman import Blocks, blocks_of_ratings, compare_pairs
from tests.analysis.reference import reference_ratings, with_reference


@with_reference
def test_they_agree_with_r_on_participant_means():
    ratings, reference = reference_ratings()
    expected = reference["participants_friedman"]
    tidy = ratings.rename(columns={"method": "condition", "rating": "value"})

    found = compare_pairs(blocks_of_ratings(tidy, list(expected["mean_rank"])))

    assert [f"{pair.a}|{pair.b}" for pair in found] == list(expected["nemenyi_p"])
    for pair in found:
        name = f"{pair.a}|{pair.b}"
        assert pair.nemenyi_p == pytest.approx(expected["nemenyi_p"][name], rel=1e-5)
        assert pair.conover_p == pytest.approx(expected["conover_p_unadjusted"][name], rel=1e-6)
        assert pair.conover_holm == pytest.approx(expected["conover_p_holm"][name], rel=1e-6)
        # R takes means that are equal but for rounding for different ones.
        plain, holm = (expected[f"wilcoxon_p_{kind}"][name] for kind in ("unadjusted", "holm"))
        assert pair.wilcoxon_normal_p == pytest.approx(plain, rel=1e-3)
        assert pair.wilcoxon_normal_holm == pytest.approx(holm, rel=1e-3)


def test_all_participants_alike_differ_surely():
    pairs = compare_pairs(Blocks(conditions=("a", "b", "c"), means=np.array([[1.0, 2, 3]] * 8)))
    assert [pair.conover_p for pair in pairs] == [0, 0, 0]
    assert [pair.difference for pair in pairs] == [1, 2, 1]


def test_conditions_that_nobody_tells_apart_give_a_reason():
    [pair] = compare_pairs(Blocks(conditions=("a", "b"), means=np.ones((5, 2))))
    assert pair.reason == "nobody tells conditions apart"
    assert math.isnan(pair.wilcoxon_p)
    assert math.isnan(pair.nemenyi_p)


def test_one_condition_has_no_pairs():
    assert compare_pairs(Blocks(conditions=("a",), means=np.ones((5, 1)))) == ()
