from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from numpy.typing import ArrayLike
from scipy import stats

from analysis.stats.friedman import compare_pairs, friedman, kendall_w, resampled_concordance
from analysis.stats.placements import Blocks, Placements, blocks_of_rankings, placements
from tests.analysis.reference import reference_ratings, with_reference
from tests.analysis.stats.made_rankings import CONDITIONS, made_rankings, ranking


def blocks(means: ArrayLike) -> Blocks:
    table = np.asarray(means, float)
    return Blocks(conditions=tuple("abcdef"[: table.shape[1]]), means=table)


def participant_means(ratings: pd.DataFrame, conditions: list[str]) -> Blocks:
    means = ratings.pivot_table(index="participant", columns="method", values="rating")
    return Blocks(conditions=tuple(conditions), means=means[conditions].to_numpy())


@with_reference
def test_it_agrees_with_r_on_participant_means() -> None:
    ratings, reference = reference_ratings()
    expected = reference["participants_friedman"]

    result = friedman(participant_means(ratings, list(expected["mean_rank"])))

    assert (result.n, len(result.mean_ranks)) == (expected["n_blocks"], expected["k"])
    assert result.mean_ranks == pytest.approx(expected["mean_rank"])
    assert result.statistic == pytest.approx(expected["friedman_chi2"], rel=1e-9)
    assert result.df == 3
    assert result.p_value == pytest.approx(expected["p"], rel=1e-6)
    assert result.kendall_w == pytest.approx(expected["kendall_W_tie_corrected"], rel=1e-9)


def test_with_ties_it_is_scipys() -> None:
    table = np.random.default_rng(1).integers(1, 4, (12, 5)).astype(float)
    expected = stats.friedmanchisquare(*table.T)
    result = friedman(blocks(table))
    assert (result.statistic, result.p_value) == pytest.approx(tuple(expected))


def test_participants_who_lack_a_condition_are_left_out_and_counted() -> None:
    table = made_rankings(participants=6)
    lacking = table[~((table["participant"] == "p01") & (table["condition"] == "last"))]
    result = friedman(blocks_of_rankings(placements(lacking, CONDITIONS)))
    assert (result.n, result.incomplete) == (5, 1)


def test_a_better_rank_is_a_larger_number() -> None:
    result = friedman(blocks_of_rankings(placements(made_rankings(spread=0), CONDITIONS)))
    assert sorted(result.mean_ranks, key=result.mean_ranks.__getitem__) == list(CONDITIONS[::-1])


def test_blocks_of_participants_find_less_that_is_not_there_than_single_rankings() -> None:
    pooled, means = [], []
    for seed in range(60):
        table = made_rankings(worths=(0, 0, 0, 0), spread=0.4, seed=seed)
        rankings = placements(table, CONDITIONS)
        pooled.append(stats.friedmanchisquare(*rankings.ranks.T).pvalue)
        means.append(friedman(blocks_of_rankings(rankings)).p_value)
    assert np.mean(np.array(means) < 0.05) < np.mean(np.array(pooled) < 0.05)


@with_reference
def test_they_agree_with_r_on_participant_means() -> None:
    ratings, reference = reference_ratings()
    expected = reference["participants_friedman"]

    result = compare_pairs(participant_means(ratings, list(expected["mean_rank"])))

    assert [f"{pair.a}|{pair.b}" for pair in result] == list(expected["nemenyi_p"])
    for pair in result:
        name = f"{pair.a}|{pair.b}"
        assert pair.nemenyi_p == pytest.approx(expected["nemenyi_p"][name], rel=1e-5)
        assert pair.conover_p == pytest.approx(expected["conover_p_unadjusted"][name], rel=1e-6)
        assert pair.conover_holm == pytest.approx(expected["conover_p_holm"][name], rel=1e-6)


def test_all_participants_alike_agree_perfectly_and_differ_surely() -> None:
    alike = blocks([[1, 2, 3]] * 8)
    pairs = compare_pairs(alike)
    assert friedman(alike).kendall_w == pytest.approx(1)
    assert [pair.conover_p for pair in pairs] == [0, 0, 0]
    assert [pair.difference for pair in pairs] == [1, 2, 1]


def test_conditions_that_nobody_tells_apart_give_a_reason() -> None:
    [pair] = compare_pairs(blocks(np.ones((5, 2))))
    assert pair.reason == "nobody tells conditions apart"
    assert math.isnan(pair.wilcoxon_p)
    assert math.isnan(pair.nemenyi_p)


ABC = ("a", "b", "c")


def test_it_is_one_where_all_agree_and_zero_where_they_cancel() -> None:
    alike = kendall_w(placements(ranking(*[{"a": 1, "b": 2, "c": 3}] * 4), ABC))
    turns = ({"a": 1, "b": 2, "c": 3}, {"a": 2, "b": 3, "c": 1}, {"a": 3, "b": 1, "c": 2})
    assert alike.segments[0].estimate == pytest.approx(1)
    assert kendall_w(placements(ranking(*turns), ABC)).segments[0].estimate == 0


def test_with_ties_it_is_the_corrected_formula() -> None:
    rows = [{"a": 1, "b": 2, "c": 2, "d": 4}, {"a": 1, "b": 1, "c": 3, "d": 3}]
    [result] = kendall_w(placements(ranking(*rows), ("a", "b", "c", "d"))).segments
    # Written out from Siegel & Castellan (1988); the sums of ranks are 2.5, 4, 6 and 7.5.
    spread = np.sum((np.array([2.5, 4, 6, 7.5]) - 5) ** 2)
    ties = (2**3 - 2) + 2 * (2**3 - 2)
    assert result.estimate == pytest.approx(12 * spread / (4 * (4**3 - 4) - 2 * ties))
    correlation = np.corrcoef([1, 2.5, 2.5, 4], [1.5, 1.5, 3.5, 3.5])[0, 1]
    assert 2 * result.estimate - 1 == pytest.approx(correlation, abs=0.02)


def test_every_segment_and_the_whole_are_told_apart() -> None:
    table = made_rankings()
    result = kendall_w(placements(table, CONDITIONS))
    assert [s.segment for s in result.segments] == [f"s{k}" for k in range(8)]
    assert result.estimate == pytest.approx(np.mean([s.estimate for s in result.segments]))
    ranks = table.pivot_table(index="participant", columns="condition", values="rank")
    whole = stats.friedmanchisquare(*(-ranks.to_numpy().round(9)).T)
    assert result.overall == pytest.approx(whole.statistic / (22 * 3))
    assert result.n == 22
    assert all(s.n == 22 and s.p_value < 1 for s in result.segments)


def test_rankings_that_leave_conditions_out_are_left_out_and_counted() -> None:
    rows = [{"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 2}]
    [result] = kendall_w(placements(ranking(*rows), ABC)).segments
    assert (result.n, result.incomplete) == (2, 1)


def test_one_participant_agrees_with_nobody() -> None:
    result = kendall_w(placements(ranking({"a": 1, "b": 2, "c": 3}), ABC))
    assert result.segments[0].reason == "fewer than two participants with all conditions"
    assert math.isnan(result.estimate)


def crossed(agreement: float, people: int = 15, things: int = 6, seed: int = 1) -> Placements:
    chance = np.random.default_rng(seed)
    worth = agreement * np.arange(4) + chance.gumbel(size=(people * things, 4))
    who, items = np.divmod(np.arange(people * things), things)
    return Placements(
        conditions=tuple("abcd"),
        given=1 + np.argsort(np.argsort(-worth, axis=1), axis=1).astype(np.float64),
        participants=who,
        segments=items,
        participant_names=tuple(map(str, range(people))),
        segment_names=tuple(map(str, range(things))),
    )


def test_its_interval_lies_around_the_mean_and_not_above_it() -> None:
    """Participants drawn twice agree with themselves; counted, they would raise it."""
    for agreement in (0.0, 0.5, 2.0):
        rankings = crossed(agreement)
        result = kendall_w(rankings)

        assert result.low < result.estimate < result.high
        drawn = resampled_concordance(rankings)
        assert drawn.mean() == pytest.approx(result.estimate, abs=0.02)


def test_it_contains_the_truth_in_nearly_all_studies() -> None:
    truth = np.mean(
        [kendall_w(crossed(0.5, 15, 40, seed), resamples=2).estimate for seed in range(20)]
    )
    inside = []
    for seed in range(40):
        result = kendall_w(crossed(0.5, seed=100 + seed), resamples=300)
        inside.append(result.low <= truth <= result.high)

    assert np.mean(inside) > 0.88


def test_one_segment_gives_no_interval_and_says_so() -> None:
    result = kendall_w(crossed(1.0, things=1))

    assert np.isnan(result.low)
    assert result.reason == "one segment gives no interval"
    assert result.estimate > 0
