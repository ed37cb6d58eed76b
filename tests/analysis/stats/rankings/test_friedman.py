from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from analysis.stats.rankings.friedman import (
    Blocks,
    blocks_of_rankings,
    compare_pairs,
    friedman,
)
from analysis.stats.rankings.placements import placements
from tests.analysis.reference import reference_ratings, with_reference
from tests.analysis.stats.rankings.made_rankings import CONDITIONS, made_rankings


def blocks(means):
    table = np.asarray(means, float)
    return Blocks(conditions=tuple("abcdef"[: table.shape[1]]), means=table)


def participant_means(ratings, conditions):
    means = ratings.pivot_table(index="participant", columns="method", values="rating")
    return Blocks(conditions=tuple(conditions), means=means[conditions].to_numpy())


@with_reference
def test_it_agrees_with_r_on_participant_means():
    ratings, reference = reference_ratings()
    expected = reference["participants_friedman"]

    found = friedman(participant_means(ratings, list(expected["mean_rank"])))

    assert (found.n, len(found.mean_ranks)) == (expected["n_blocks"], expected["k"])
    assert found.mean_ranks == pytest.approx(expected["mean_rank"])
    assert found.statistic == pytest.approx(expected["friedman_chi2"], rel=1e-9)
    assert (found.df, found.p_value) == (3, pytest.approx(expected["p"], rel=1e-6))
    assert found.iman_davenport.statistic == pytest.approx(expected["iman_davenport_F"], rel=1e-9)
    assert [found.iman_davenport.df, found.iman_davenport.df_rest] == expected["F_df"]
    assert found.iman_davenport.p_value == pytest.approx(expected["F_p"], rel=1e-6)
    assert found.kendall_w == pytest.approx(expected["kendall_W_tie_corrected"], rel=1e-9)


def test_with_ties_it_is_scipys():
    table = np.random.default_rng(1).integers(1, 4, (12, 5)).astype(float)
    expected = stats.friedmanchisquare(*table.T)
    found = friedman(blocks(table))
    assert (found.statistic, found.p_value) == pytest.approx(tuple(expected))


def test_all_alike_is_perfect_concordance_and_no_error():
    found = friedman(blocks([[1, 2, 3]] * 5))
    assert found.kendall_w == pytest.approx(1)
    assert (found.iman_davenport.statistic, found.iman_davenport.p_value) == (math.inf, 0)


def test_participants_who_lack_a_condition_are_left_out_and_counted():
    table = made_rankings(participants=6)
    lacking = table[~((table["participant"] == "p01") & (table["condition"] == "last"))]
    found = friedman(blocks_of_rankings(placements(lacking, CONDITIONS)))
    assert (found.n, found.incomplete) == (5, 1)


def test_a_better_rank_is_a_larger_number():
    found = friedman(blocks_of_rankings(placements(made_rankings(spread=0), CONDITIONS)))
    assert sorted(found.mean_ranks, key=found.mean_ranks.__getitem__) == list(CONDITIONS[::-1])


def test_blocks_of_participants_find_less_that_is_not_there_than_single_rankings():
    pooled, means = [], []
    for seed in range(60):
        table = made_rankings(worths=(0, 0, 0, 0), spread=0.4, seed=seed)
        rankings = placements(table, CONDITIONS)
        pooled.append(stats.friedmanchisquare(*rankings.ranks.T).pvalue)
        means.append(friedman(blocks_of_rankings(rankings)).p_value)
    assert np.mean(np.array(means) < 0.05) < np.mean(np.array(pooled) < 0.05)


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ([[1], [2]], "fewer than two conditions"),
        ([[1, 2, 3]], "fewer than two participants with all conditions"),
        (np.zeros((0, 3)), "fewer than two participants with all conditions"),
        ([[2, 2], [1, 1]], "nobody tells conditions apart"),
    ],
)
def test_no_test_comes_with_its_reason(table, reason):
    found = friedman(blocks(table))
    assert found.reason == reason
    assert math.isnan(found.p_value)


@with_reference
def test_they_agree_with_r_on_participant_means():
    ratings, reference = reference_ratings()
    expected = reference["participants_friedman"]

    found = compare_pairs(participant_means(ratings, list(expected["mean_rank"])))

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
