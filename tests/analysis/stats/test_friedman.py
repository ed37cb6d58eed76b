from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy import stats

from analysis.stats.agreement import kendall_w, resampled_concordance
from analysis.stats.rankings import (
    Blocks,
    Placements,
    blocks_of_rankings,
    compare_pairs,
    friedman,
    placements,
)
from tests.analysis.reference import reference_ratings, with_reference
from tests.analysis.stats.made_rankings import CONDITIONS, made_rankings


def blocks(means: ArrayLike) -> Blocks:
    table = np.asarray(means, float)
    return Blocks(conditions=tuple("abcdef"[: table.shape[1]]), means=table)


@with_reference
def test_it_agrees_with_r_on_participant_means() -> None:
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


def test_with_ties_it_is_scipys() -> None:
    table = np.random.default_rng(1).integers(1, 4, (12, 5)).astype(float)
    expected = stats.friedmanchisquare(*table.T)
    result = friedman(blocks(table))
    assert (result.statistic, result.p_value) == pytest.approx(tuple(expected))


def test_all_participants_alike_agree_perfectly_and_differ_surely() -> None:
    alike = blocks([[1, 2, 3]] * 8)
    pairs = compare_pairs(alike)
    assert friedman(alike).kendall_w == pytest.approx(1)
    assert [pair.conover_p for pair in pairs] == [0, 0, 0]
    assert [pair.difference for pair in pairs] == [1, 2, 1]


def test_who_leaves_a_condition_out_is_left_out_and_counted() -> None:
    table = made_rankings(participants=6, segments=1)
    lacking = table[~((table["participant"] == "p01") & (table["condition"] == "last"))]
    rankings = placements(lacking, CONDITIONS)
    whole, [segment] = friedman(blocks_of_rankings(rankings)), kendall_w(rankings).segments
    assert (whole.n, whole.incomplete) == (segment.n, segment.incomplete) == (5, 1)


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


def crossed(agreement: float, people: int = 15, things: int = 6) -> Placements:
    chance = np.random.default_rng(1)
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
