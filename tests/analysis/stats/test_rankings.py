import numpy as np
import pandas as pd
import pytest
from scipy import stats

from analysis.stats.agreement import kendall_w, resampled_concordance
from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.rankings import (
    Blocks,
    blocks_of_rankings,
    compare_pairs,
    friedman,
    placements,
    rank_summaries,
)
from tests.analysis.reference import reference_ratings, with_reference
from tests.analysis.results.made_tables import ranking_table

ABC = ("a", "b", "c")

CONDITIONS = ("truth", "ours", "static")


def ranking(*rows: dict[str, int]) -> pd.DataFrame:
    """Return one ranking per participant, all of one segment."""
    return pd.DataFrame(
        [
            {"participant": f"p{number}", "segment": "s", "condition": name, "rank": rank}
            for number, row in enumerate(rows)
            for name, rank in row.items()
        ]
    )


def test_ties_share_their_mean_rank_however_they_are_numbered() -> None:
    for tied in (1, 2):
        result = placements(ranking({"a": 1, "b": 1, "c": tied + 1}), ABC)
        assert result.ranks.tolist() == [[1.5, 1.5, 3]]
        assert result.better.tolist() == [[0, 0, 2]]
        assert result.tied.tolist() == [[2, 2, 1]]


def test_an_omitted_condition_has_no_rank_and_occupies_none() -> None:
    result = placements(ranking({"a": 2, "c": 1}), ABC)
    assert result.ranks[0, [0, 2]].tolist() == [2, 1]
    assert np.isnan(result.ranks[0, 1])
    assert result.complete.tolist() == [False]


def test_shares_of_places_worked_by_hand() -> None:
    table = ranking({"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 1, "c": 3}, {"b": 1, "a": 2, "c": 2})
    a, b, c = rank_summaries(placements(table, ABC))
    assert tuple(a.rank_percent.values()) == pytest.approx((50, 100 / 3, 100 / 6))
    assert tuple(b.rank_percent.values()) == pytest.approx((50, 50, 0))
    assert tuple(c.rank_percent.values()) == pytest.approx((0, 100 / 6, 250 / 3))
    assert [s.mean_rank.estimate for s in (a, b, c)] == pytest.approx([5 / 3, 4.5 / 3, 8.5 / 3])
    assert a.first_share.estimate == pytest.approx(0.5)


def test_a_ranking_that_leaves_conditions_out_is_tested_against_the_chance_of_the_others() -> None:
    pairs = ({"a": 1, "b": 2}, {"a": 2, "b": 1}, {"b": 1, "c": 2}, {"b": 2, "c": 1})
    for summary in rank_summaries(placements(ranking(*pairs, *pairs), ABC)):
        assert summary.mean_rank.estimate == 1.5
        assert summary.mean_rank.p_value == pytest.approx(1)
        assert summary.first_share.p_value == pytest.approx(1)


def test_the_two_way_interval_of_a_mean_rank_stays_within_the_ranks() -> None:
    table = ranking_table()
    result = rank_summaries(placements(table, CONDITIONS))[1]
    own = table[table["condition"] == "ours"]
    clusters = (own[name].to_numpy(str) for name in ("participant", "segment"))
    expected = clustered_mean(own["rank"].to_numpy(float), *clusters, null=2, limits=(1, 3))
    assert result.mean_rank == expected
    assert result.mean_rank.participants == 12


@with_reference
def test_friedmans_test_and_pairwise_tests_agree_with_r() -> None:
    ratings, reference = reference_ratings()
    expected = reference["participants_friedman"]

    means = ratings.pivot_table(index="participant", columns="method", values="rating")
    names = tuple(expected["mean_rank"])
    participants = Blocks(conditions=names, means=means[list(names)].to_numpy())
    result, pairs = friedman(participants), compare_pairs(participants)

    assert (result.n, len(result.mean_ranks)) == (expected["n_blocks"], expected["k"])
    assert result.mean_ranks == pytest.approx(expected["mean_rank"])
    assert result.statistic == pytest.approx(expected["friedman_chi2"], rel=1e-9)
    assert result.df == 3
    assert result.p_value == pytest.approx(expected["p"], rel=1e-6)
    assert result.kendall_w == pytest.approx(expected["kendall_W_tie_corrected"], rel=1e-9)
    assert [f"{pair.a}|{pair.b}" for pair in pairs] == list(expected["nemenyi_p"])
    for pair in pairs:
        name = f"{pair.a}|{pair.b}"
        assert pair.nemenyi_p == pytest.approx(expected["nemenyi_p"][name], rel=1e-5)
        assert pair.conover_p == pytest.approx(expected["conover_p_unadjusted"][name], rel=1e-6)
        assert pair.conover_holm == pytest.approx(expected["conover_p_holm"][name], rel=1e-6)


def test_with_ties_friedmans_test_agrees_with_scipy() -> None:
    table = np.random.default_rng(1).integers(1, 4, (12, 5)).astype(float)
    expected = stats.friedmanchisquare(*table.T)
    result = friedman(Blocks(conditions=tuple("abcde"), means=table))
    assert (result.statistic, result.p_value) == pytest.approx(tuple(expected))


def test_identical_rankings_agree_perfectly() -> None:
    alike = Blocks(conditions=ABC, means=np.array([[1.0, 2, 3]] * 8))
    pairs = compare_pairs(alike)
    assert friedman(alike).kendall_w == pytest.approx(1)
    assert [pair.conover_p for pair in pairs] == [0, 0, 0]
    assert [pair.difference for pair in pairs] == [1, 2, 1]


def test_incomplete_rankings_are_left_out_and_counted() -> None:
    table = ranking_table(participants=6, segments=1)
    lacking = table[~((table["participant"] == "p01") & (table["condition"] == "static"))]
    rankings = placements(lacking, CONDITIONS)
    whole, [segment] = friedman(blocks_of_rankings(rankings)), kendall_w(rankings).segments
    assert (whole.n, whole.incomplete) == (segment.n, segment.incomplete) == (5, 1)


def test_kendalls_w_is_given_for_each_segment_and_overall() -> None:
    table = ranking_table()
    result = kendall_w(placements(table, CONDITIONS))
    assert [s.segment for s in result.segments] == [f"s{k}" for k in range(6)]
    assert result.estimate == pytest.approx(np.mean([s.estimate for s in result.segments]))
    ranks = table.pivot_table(index="participant", columns="condition", values="rank")
    whole = stats.friedmanchisquare(*(-ranks.to_numpy().round(9)).T)
    assert result.overall == pytest.approx(whole.statistic / (12 * 2))
    assert result.n == 12
    assert all(s.n == 12 and s.p_value < 1 for s in result.segments)


def test_the_interval_of_kendalls_w_contains_its_mean() -> None:
    """Participants drawn twice agree with themselves; counted, they would raise it."""
    rankings = placements(ranking_table(), CONDITIONS)
    result = kendall_w(rankings)

    assert result.low < result.estimate < result.high
    assert resampled_concordance(rankings).mean() == pytest.approx(result.estimate, abs=0.02)
    few = kendall_w(placements(ranking_table(participants=3, segments=3, seed=3), CONDITIONS))
    assert 0 <= few.low < few.high <= 1
    alone = kendall_w(placements(ranking_table(segments=1), CONDITIONS))
    assert alone.reason == "one segment gives no interval"
    assert alone.estimate > 0
    assert np.isnan(alone.low)
