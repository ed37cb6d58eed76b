from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from statsmodels.discrete.discrete_model import Logit
from statsmodels.stats.sandwich_covariance import cov_cluster_2groups

from analysis.stats.clustered_mean import ONE_SEGMENT, TWO_WAY
from analysis.stats.strength_differences import MIXED, TwoWayErrors, omnibus, rank_intervals
from analysis.stats.strength_models import Votes, bradley_terry
from tests.analysis.stats.named_votes import votes_of


def made_votes(taste: float = 1.0, luck: float = 1.0) -> Votes:
    """Thirty participants and twelve segments differ in which of four conditions they favour."""
    chance = np.random.default_rng(3)
    people, items = np.repeat(np.arange(30), 36), np.tile(np.arange(36) % 12, 30)
    worth = taste * chance.normal(size=(30, 4))[people] + luck * chance.normal(size=(12, 4))[items]
    left = chance.integers(4, size=len(people))
    right = (left + chance.integers(1, 4, size=len(people))) % 4
    rows = np.arange(len(people))
    latent = worth[rows, left] - worth[rows, right] + chance.logistic(size=len(people))
    return Votes(
        conditions=("a", "b", "c", "d"),
        left=left,
        right=right,
        outcome=np.where(latent > 0, 1, -1),
        participant=people,
        segment=items,
    )


def test_errors_agree_with_those_of_a_logistic_regression() -> None:
    votes = made_votes()
    design = np.eye(4)[votes.left] - np.eye(4)[votes.right]
    fitted = Logit((votes.outcome > 0).astype(float), design[:, 1:]).fit(disp=False)
    covariance = cov_cluster_2groups(fitted, votes.participant, votes.segment)[0]
    covariance = covariance * (len(design) - 3) / (len(design) - 1)  # Its factor for few answers.
    turn = np.eye(4)[:, 1:] - 1 / 4

    result = bradley_terry(votes, left_effect=False)

    assert result.strengths == pytest.approx(turn @ fitted.params)
    assert result.two_way is not None
    assert result.two_way.method == TWO_WAY
    # Theirs is CR1, from which CR2 differs little where all have answered alike often.
    assert result.errors_two_way == pytest.approx(
        np.sqrt(np.diagonal(turn @ covariance @ turn.T)), rel=5e-3
    )
    assert result.two_way.differences[0, 1:] == pytest.approx(
        np.sqrt(np.diagonal(covariance)), rel=5e-3
    )
    two_way = result.two_way.by_participant + result.two_way.by_segment - result.two_way.by_cell
    assert two_way == pytest.approx(turn @ covariance @ turn.T, rel=1e-6)


def test_a_larger_one_way_variance_takes_the_place_of_the_two_way_one() -> None:
    votes = made_votes(taste=0.0, luck=0.0)
    result = bradley_terry(votes)

    assert result.two_way is not None
    assert result.two_way.method == MIXED
    matrix = result.two_way.by_participant
    own = np.diagonal(matrix)
    of_participants = own[:, None] + own - 2 * matrix
    assert (result.two_way.differences**2 >= 0.999 * of_participants - 1e-12).all()


def test_of_one_segment_they_are_those_of_participants() -> None:
    votes = made_votes()

    result = bradley_terry(replace(votes, segment=np.zeros_like(votes.left)))

    assert result.two_way is not None
    assert result.two_way.method == ONE_SEGMENT
    assert result.errors_two_way == pytest.approx(result.errors, rel=0.03)


def p_values(strengths: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    own = np.diagonal(covariance)
    errors = np.sqrt(own[:, None] + own - 2 * covariance + 1e-300)
    return np.asarray(2 * stats.norm.sf(np.abs(strengths[:, None] - strengths) / errors))


@pytest.mark.parametrize(
    ("strengths", "ranks"),
    [
        ([0.0, 2.0, -2.0], ((2, 2), (1, 1), (3, 3))),
        # Told apart alone at .034, but not among three tests.
        ([0.0, 0.3, -2.0], ((1, 2), (1, 2), (3, 3))),
        ([np.nan] * 3, ((1, 3),) * 3),
    ],
)
def test_what_cannot_be_told_apart_shares_its_ranks(
    strengths: list[float], ranks: tuple[tuple[int, int], ...]
) -> None:
    values = np.array(strengths)
    assert rank_intervals(values, p_values(values, 0.01 * np.eye(3))) == ranks


def test_one_test_of_all_strengths_is_hotellings_where_participants_alone_are_a_sample() -> None:
    chance = np.random.default_rng(4)
    given = chance.normal(size=(15, 3)) + np.array([0.6, 0.0, 0.0])
    influences = (given - given.mean(axis=0)) / len(given)
    alone = np.zeros(15, int)
    errors = TwoWayErrors.of(influences, alone, np.arange(15), np.arange(15), alone)
    assert errors is not None

    result = omnibus(given.mean(axis=0), errors)

    turn = np.array([[-1, 1, 0], [-1, 0, 1]])
    means, spread = turn @ given.mean(axis=0), turn @ np.cov(given.T) @ turn.T
    squared = 15 * means @ np.linalg.solve(spread, means)
    assert (result.df, result.df_rest) == pytest.approx((2, 13))
    assert result.p_value == pytest.approx(stats.f.sf(squared * 13 / (14 * 2), 2, 13))


def test_too_few_segments_have_no_test_of_all_and_say_so() -> None:
    votes = made_votes()
    few = replace(votes, segment=votes.segment % 3)
    result = bradley_terry(few)
    assert result.two_way is not None
    assert (
        "too few for one test of 4 conditions" in omnibus(result.strengths, result.two_way).reason
    )


def test_the_prior_is_half_a_win_and_half_a_loss_against_the_average() -> None:
    votes = votes_of(["c"] * 9, ["a"] * 9, [1] * 9, [str(n) for n in range(9)])
    result = bradley_terry(votes, left_effect=False)
    # With strengths s and -s: 9 log F(2s) + 2 * (log F(s) + log F(-s)) / 2 is largest.
    tried = np.linspace(0, 6, 60_001)
    value = -9 * np.log1p(np.exp(-2 * tried)) - np.log1p(np.exp(-tried)) - np.log1p(np.exp(tried))
    assert result.strengths[0] == pytest.approx(tried[value.argmax()], abs=1e-3)
    assert result.log_likelihood == pytest.approx(-9 * np.log1p(np.exp(-2 * result.strengths[0])))
