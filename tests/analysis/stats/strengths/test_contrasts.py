from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from analysis.stats.strengths.bradley_terry import bradley_terry
from analysis.stats.strengths.contrasts import omnibus, rank_intervals
from analysis.stats.strengths.two_way import TwoWayErrors
from analysis.stats.strengths.votes import Votes
from tests.analysis.stats.strengths.named_votes import votes_of
from tests.analysis.stats.strengths.test_two_way import made_votes


def p_values(strengths: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    own = np.diagonal(covariance)
    errors = np.sqrt(own[:, None] + own - 2 * covariance + 1e-300)
    return np.asarray(2 * stats.norm.sf(np.abs(strengths[:, None] - strengths) / errors))


@pytest.mark.parametrize(
    ("strengths", "ranks"),
    [
        ([0.0, 2.0, -2.0], ((2, 2), (1, 1), (3, 3))),
        ([0.0, 0.1, -2.0], ((1, 2), (1, 2), (3, 3))),
        ([np.nan] * 3, ((1, 3),) * 3),
    ],
)
def test_what_cannot_be_told_apart_shares_its_ranks(
    strengths: list[float], ranks: tuple[tuple[int, int], ...]
) -> None:
    values = np.array(strengths)
    assert rank_intervals(values, p_values(values, 0.01 * np.eye(3))) == ranks


def test_the_true_rank_is_inside_nearly_always() -> None:
    chance = np.random.default_rng(1)
    truth = np.array([0.3, 0.1, 0.0, -0.4])
    covariance = 0.02 * np.eye(4)
    inside = []
    for _ in range(300):
        drawn = chance.multivariate_normal(truth, covariance)
        intervals = rank_intervals(drawn, p_values(drawn, covariance))
        inside.append(all(low <= n <= high for n, (low, high) in enumerate(intervals, start=1)))

    assert np.mean(inside) > 0.93


def test_one_test_of_all_strengths_is_hotellings_where_participants_alone_are_a_sample() -> None:
    chance = np.random.default_rng(4)
    given = chance.normal(size=(15, 3)) + np.array([0.6, 0.0, 0.0])
    influences = (given - given.mean(axis=0)) / len(given)
    alone = np.zeros(15, int)
    errors = TwoWayErrors.of(influences, alone, np.arange(15), np.arange(15), alone)
    assert errors is not None

    found = omnibus(given.mean(axis=0), errors)

    turn = np.array([[-1, 1, 0], [-1, 0, 1]])
    means, spread = turn @ given.mean(axis=0), turn @ np.cov(given.T) @ turn.T
    squared = 15 * means @ np.linalg.solve(spread, means)
    assert (found.df, found.df_rest) == pytest.approx((2, 13))
    assert found.p_value == pytest.approx(stats.f.sf(squared * 13 / (14 * 2), 2, 13))


def test_strengths_that_differ_are_found_by_one_test_and_by_contrasts() -> None:
    votes = made_votes()
    found = bradley_terry(votes)
    assert found.two_way is not None
    together = omnibus(found.strengths, found.two_way)
    assert together.df == 3
    assert together.df_rest == pytest.approx(found.two_way.freedom - 2)
    assert 0 < together.p_value <= 1


def test_too_few_segments_have_no_test_of_all_and_say_so() -> None:
    votes = made_votes()
    assert votes.segment is not None
    few = Votes(**{**vars(votes), "segment": votes.segment % 3})
    found = bradley_terry(few)
    assert found.two_way is not None
    assert "too few for one test of 4 conditions" in omnibus(found.strengths, found.two_way).reason


def swept() -> Votes:
    """C wins all of its 40 votes; a and b share theirs."""
    return votes_of(
        ["c"] * 40 + ["a", "b"] * 20,
        ["a", "b"] * 20 + ["b", "a"] * 20,
        [1] * 40 + [1, 1, -1] * 13 + [1],
        [f"p{number % 10}" for number in range(80)],
        segment=[f"s{number % 8}" for number in range(80)],
    )


def test_who_never_lost_has_a_strength_after_a_prior_and_is_named() -> None:
    found = bradley_terry(swept(), left=False)
    assert not found.reason
    assert found.swept == "c never lost to any of the others"
    assert np.isfinite(found.strengths).all()
    assert found.strengths[found.conditions.index("c")] > 2


def test_the_prior_is_half_a_win_and_half_a_loss_against_the_average() -> None:
    votes = votes_of(["c"] * 9, ["a"] * 9, [1] * 9, [str(n) for n in range(9)])
    found = bradley_terry(votes, left=False)
    # With strengths s and -s: 9 log F(2s) + 2 * (log F(s) + log F(-s)) / 2 is largest.
    tried = np.linspace(0, 6, 60_001)
    value = -9 * np.log1p(np.exp(-2 * tried)) - np.log1p(np.exp(-tried)) - np.log1p(np.exp(tried))
    assert found.strengths[0] == pytest.approx(tried[value.argmax()], abs=1e-3)
    assert found.log_likelihood == pytest.approx(-9 * np.log1p(np.exp(-2 * found.strengths[0])))


def test_groups_that_were_never_compared_are_named() -> None:
    votes = votes_of(["a", "b", "c", "d"], ["b", "a", "d", "c"], [1, 1, 1, 1], ["p", "q"] * 2)
    assert bradley_terry(votes).reason == (
        "never compared with one another, not even through others: a and b | c and d; strengths "
        "have no common scale"
    )
