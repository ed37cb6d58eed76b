from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from analysis.stats.rankings.kendall_w import kendall_w, resampled_concordance
from analysis.stats.rankings.placements import Placements, placements
from tests.analysis.stats.rankings.made_rankings import CONDITIONS, made_rankings, ranking

ABC = ("a", "b", "c")


def test_it_is_one_where_all_agree_and_zero_where_they_cancel():
    alike = kendall_w(placements(ranking(*[{"a": 1, "b": 2, "c": 3}] * 4), ABC))
    turns = ({"a": 1, "b": 2, "c": 3}, {"a": 2, "b": 3, "c": 1}, {"a": 3, "b": 1, "c": 2})
    assert alike.segments[0].estimate == pytest.approx(1)
    assert kendall_w(placements(ranking(*turns), ABC)).segments[0].estimate == 0


def test_with_ties_it_is_the_corrected_formula():
    rows = [{"a": 1, "b": 2, "c": 2, "d": 4}, {"a": 1, "b": 1, "c": 3, "d": 3}]
    [found] = kendall_w(placements(ranking(*rows), ("a", "b", "c", "d"))).segments
    # Written out from Siegel & Castellan (1988); the sums of ranks are 2.5, 4, 6 and 7.5.
    spread = np.sum((np.array([2.5, 4, 6, 7.5]) - 5) ** 2)
    ties = (2**3 - 2) + 2 * (2**3 - 2)
    assert found.estimate == pytest.approx(12 * spread / (4 * (4**3 - 4) - 2 * ties))
    correlation = np.corrcoef([1, 2.5, 2.5, 4], [1.5, 1.5, 3.5, 3.5])[0, 1]
    assert 2 * found.estimate - 1 == pytest.approx(correlation, abs=0.02)


def test_every_segment_and_the_whole_are_told_apart():
    table = made_rankings()
    found = kendall_w(placements(table, CONDITIONS))
    assert [s.segment for s in found.segments] == [f"s{k}" for k in range(8)]
    assert found.estimate == pytest.approx(np.mean([s.estimate for s in found.segments]))
    ranks = table.pivot_table(index="participant", columns="condition", values="rank")
    whole = stats.friedmanchisquare(*(-ranks.to_numpy().round(9)).T)
    assert found.overall == pytest.approx(whole.statistic / (22 * 3))
    assert found.n == 22
    assert all(s.n == 22 and s.p_value < 1 for s in found.segments)


def test_rankings_that_leave_conditions_out_are_left_out_and_counted():
    rows = [{"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 2, "c": 3}, {"a": 1, "b": 2}]
    [found] = kendall_w(placements(ranking(*rows), ABC)).segments
    assert (found.n, found.incomplete) == (2, 1)


def test_one_participant_agrees_with_nobody():
    found = kendall_w(placements(ranking({"a": 1, "b": 2, "c": 3}), ABC))
    assert found.segments[0].reason == "fewer than two participants with all conditions"
    assert math.isnan(found.estimate)


def crossed(agreement: float, people: int = 15, things: int = 6, seed: int = 1) -> Placements:
    chance = np.random.default_rng(seed)
    worth = agreement * np.arange(4) + chance.gumbel(size=(people * things, 4))
    who, what = np.divmod(np.arange(people * things), things)
    return Placements(
        conditions=tuple("abcd"),
        given=np.argsort(np.argsort(-worth, axis=1), axis=1) + 1.0,
        participants=who,
        segments=what,
        participant_names=tuple(map(str, range(people))),
        segment_names=tuple(map(str, range(things))),
    )


def test_its_interval_lies_around_the_mean_and_not_above_it() -> None:
    """Participants drawn twice agree with themselves; counted, they would raise it."""
    for agreement in (0.0, 0.5, 2.0):
        rankings = crossed(agreement)
        found = kendall_w(rankings)

        assert found.low < found.estimate < found.high
        drawn = resampled_concordance(rankings)
        assert drawn.mean() == pytest.approx(found.estimate, abs=0.02)


def test_it_contains_the_truth_in_nearly_all_studies() -> None:
    truth = np.mean(
        [kendall_w(crossed(0.5, 15, 40, seed), resamples=2).estimate for seed in range(20)]
    )
    inside = []
    for seed in range(40):
        found = kendall_w(crossed(0.5, seed=100 + seed), resamples=300)
        inside.append(found.low <= truth <= found.high)

    assert np.mean(inside) > 0.88


def test_one_segment_gives_no_interval_and_says_so() -> None:
    found = kendall_w(crossed(1.0, things=1))

    assert np.isnan(found.low)
    assert found.reason == "one segment gives no interval"
    assert found.estimate > 0
