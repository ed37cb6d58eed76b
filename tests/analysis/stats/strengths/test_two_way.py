from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from statsmodels.discrete.discrete_model import Logit
from statsmodels.stats.sandwich_covariance import cov_cluster_2groups

from analysis.stats.clustered_variance import ONE_SEGMENT, TWO_WAY
from analysis.stats.strengths.bradley_terry import bradley_terry
from analysis.stats.strengths.plackett_luce import plackett_luce
from analysis.stats.strengths.rao_kupper import rao_kupper
from analysis.stats.strengths.two_way import MIXED
from analysis.stats.strengths.votes import Votes


def made_votes(taste: float = 1.0, luck: float = 1.0) -> Votes:
    """Thirty participants and twelve segments differ in which of four conditions they favour."""
    chance = np.random.default_rng(3)
    who, what = np.repeat(np.arange(30), 36), np.tile(np.arange(36) % 12, 30)
    worth = taste * chance.normal(size=(30, 4))[who] + luck * chance.normal(size=(12, 4))[what]
    left = chance.integers(4, size=len(who))
    right = (left + chance.integers(1, 4, size=len(who))) % 4
    rows = np.arange(len(who))
    latent = worth[rows, left] - worth[rows, right] + chance.logistic(size=len(who))
    return Votes(
        conditions=("a", "b", "c", "d"),
        left=left,
        right=right,
        outcome=np.where(latent > 0, 1, -1),
        participant=who,
        segment=what,
    )


def test_errors_agree_with_those_of_a_logistic_regression() -> None:
    votes = made_votes()
    design = np.eye(4)[votes.left] - np.eye(4)[votes.right]
    fitted = Logit((votes.outcome > 0).astype(float), design[:, 1:]).fit(disp=False)
    covariance = cov_cluster_2groups(fitted, votes.participant, votes.segment)[0]
    covariance = covariance * (len(design) - 3) / (len(design) - 1)  # Its factor for few answers.
    turn = np.eye(4)[:, 1:] - 1 / 4

    found = bradley_terry(votes, left=False)

    assert found.two_way is not None
    assert found.two_way.method == TWO_WAY
    # Theirs is CR1, from which CR2 differs little where all have answered alike often.
    assert found.errors_two_way == pytest.approx(
        np.sqrt(np.diagonal(turn @ covariance @ turn.T)), rel=5e-3
    )
    assert found.two_way.differences[0, 1:] == pytest.approx(
        np.sqrt(np.diagonal(covariance)), rel=5e-3
    )
    two_way = found.two_way.by_participant + found.two_way.by_segment - found.two_way.by_cell
    assert two_way == pytest.approx(turn @ covariance @ turn.T, rel=1e-6)


def test_segments_that_differ_make_errors_larger_than_those_of_participants_alone() -> None:
    found = bradley_terry(made_votes(taste=0.3, luck=1.5))

    assert (found.errors_two_way > 1.5 * found.errors).all()


def test_a_larger_one_way_variance_takes_the_place_of_the_two_way_one() -> None:
    votes = made_votes(taste=0.0, luck=0.0)
    found = bradley_terry(votes)

    assert found.two_way is not None
    assert found.two_way.method == MIXED
    matrix = found.two_way.by_participant
    own = np.diagonal(matrix)
    of_participants = own[:, None] + own - 2 * matrix
    assert (found.two_way.differences**2 >= 0.999 * of_participants - 1e-12).all()


def test_of_one_segment_they_are_those_of_participants() -> None:
    votes = made_votes()

    found = bradley_terry(replace(votes, segment=np.zeros_like(votes.left)))

    assert found.two_way is not None
    assert found.two_way.method == ONE_SEGMENT
    assert found.errors_two_way == pytest.approx(found.errors, rel=0.03)


def test_there_are_none_with_one_participant_or_unknown_segments() -> None:
    votes = made_votes()

    found = bradley_terry(replace(votes, participant=np.zeros_like(votes.left)))

    assert found.two_way is None
    assert np.isnan(found.errors_two_way).all()
    assert bradley_terry(replace(votes, segment=None)).two_way is None


def test_ties_as_unseen_differences_have_them_too() -> None:
    votes = made_votes()
    outcome = np.where(np.arange(len(votes.left)) % 5 == 0, 0, votes.outcome)

    found = rao_kupper(replace(votes, outcome=outcome))
    davidson = bradley_terry(replace(votes, outcome=outcome))

    assert found.errors_two_way == pytest.approx(davidson.errors_two_way, rel=0.2)


def test_rankings_of_two_conditions_are_votes() -> None:
    votes = made_votes()
    two = (votes.left < 2) & (votes.right < 2)
    votes = Votes(
        conditions=("a", "b"),
        left=votes.left[two],
        right=votes.right[two],
        outcome=votes.outcome[two],
        participant=votes.participant[two],
        segment=None if votes.segment is None else votes.segment[two],
    )
    count = len(votes.left)
    rows = pd.DataFrame(
        {
            "ranking": np.repeat(np.arange(count), 2),
            "participant": np.repeat(votes.participant, 2),
            "segment": np.repeat(votes.segment, 2),
            "condition": np.array(["a", "b"])[np.stack([votes.left, votes.right], 1)].ravel(),
            "rank": np.stack([1 + (votes.outcome < 0), 1 + (votes.outcome > 0)], 1).ravel(),
        }
    )

    ranked = plackett_luce(rows, conditions=("a", "b"))

    found = bradley_terry(votes, left=False)
    assert ranked.strengths == pytest.approx(found.strengths, abs=1e-8)
    assert ranked.errors_two_way == pytest.approx(found.errors_two_way, rel=1e-4)
    assert plackett_luce(rows.drop(columns="segment")).two_way is None
