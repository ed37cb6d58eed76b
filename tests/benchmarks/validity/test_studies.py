from __future__ import annotations

import numpy as np
import pytest

from benchmarks.validity.studies import (
    Design,
    judgements,
    preferences,
    ratings,
    true_mean_rating,
    true_outcomes,
    true_rating_difference,
    true_win_share,
    votes,
)

LARGE = Design(participants=700, items=700, effect=0.8, participant_sd=0.6, item_sd=0.45)
NOTHING = Design(participants=5, items=4, effect=0.0, participant_sd=0.6, item_sd=0.45)


def test_the_true_win_share_is_what_many_answers_tend_to() -> None:
    made = preferences(LARGE, np.random.default_rng(1))

    assert made.wins.mean() == pytest.approx(true_win_share(LARGE), abs=0.01)
    assert true_win_share(NOTHING) == pytest.approx(0.5)


@pytest.mark.parametrize("tastes", [True, False])
def test_the_true_rating_difference_is_what_many_ratings_tend_to(tastes: bool) -> None:
    chance = np.random.default_rng(2)
    judged = judgements(LARGE, 2, chance, differ=tastes)

    given = ratings(judged, LARGE, chance)

    assert given.min() == 1
    assert given.max() == 5
    truth = true_rating_difference(LARGE, tastes=tastes)
    assert (given[:, 0] - given[:, 1]).mean() == pytest.approx(truth, abs=0.05)
    assert given[:, 0].mean() == pytest.approx(true_mean_rating(LARGE, tastes=tastes), abs=0.05)


def test_the_true_outcomes_are_what_many_votes_tend_to() -> None:
    chance = np.random.default_rng(3)
    judged = judgements(LARGE, 2, chance)

    left, right, outcome = votes(judged, chance)

    assert (left != right).all()
    for_first = np.where(left == 0, outcome, -outcome)
    shares = [(for_first == result).mean() for result in (1, 0, -1)]
    assert shares == pytest.approx(true_outcomes(LARGE), abs=0.01)


def test_differences_of_conditions_vary_as_the_design_says() -> None:
    design = Design(participants=600, items=600, effect=0.0, participant_sd=0.6, item_sd=0.45)

    worth = judgements(design, 2, np.random.default_rng(4)).worth

    assert np.std(worth[:, 0] - worth[:, 1]) == pytest.approx(design.spread, rel=0.05)
