from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats
from statsmodels.stats.inter_rater import cohens_kappa

from analysis.stats.retest import retest_agreement


def made(people=30, trials=3, noise=0.8, seed=1):
    generator = np.random.default_rng(seed)
    latent = generator.normal(0, 1, people * trials)
    first, again = (
        np.clip(np.rint(latent + generator.normal(0, noise, len(latent))), -2, 2).astype(int)
        for _ in range(2)
    )
    return first, again, np.repeat(np.arange(people), trials)


def test_kappa_agrees_with_another_implementation():
    first, again, people = made()
    table = np.zeros((5, 5))
    np.add.at(table, (first + 2, again + 2), 1)
    found = retest_agreement(first, again, people)
    assert found.kappa == pytest.approx(cohens_kappa(table, wt="quadratic").kappa)
    assert found.spearman == pytest.approx(stats.spearmanr(first, again).statistic)
    assert found.equal_share == pytest.approx((first == again).mean())
    assert found.low < found.kappa < found.high
    assert found.equal_low < found.equal_share < found.equal_high
    assert (found.n, found.participants, found.reason) == (90, 30, "")


def test_the_same_answers_again_are_full_agreement():
    first, _, people = made()
    found = retest_agreement(first, first, people)
    assert (found.kappa, found.low, found.high, found.equal_share) == (1, 1, 1, 1)


def test_chance_is_no_agreement():
    first, _, people = made(people=300)
    other = np.random.default_rng(9).permutation(first)
    assert abs(retest_agreement(first, other, people).kappa) < 0.15


def test_a_participant_counts_as_one_however_many_trials():
    first, again, people = made()
    thrice = [np.tile(column, 3) for column in (first, again, people)]
    once, more = retest_agreement(first, again, people), retest_agreement(*thrice)
    assert (more.low, more.high) == pytest.approx((once.low, once.high))
    assert more.n == 3 * once.n


@pytest.mark.parametrize(
    ("first", "again", "people", "reason"),
    [
        ([], [], [], "no trial was answered again"),
        ([1, 2], [1, 1], [0, 0], "one participant gives no interval"),
        ([0, 0], [0, 0], [0, 1], "all answers alike"),
        ([0, 1], [1, 1], [0, 1], "one side's answers are all alike"),
    ],
)
def test_a_missing_number_comes_with_its_reason(first, again, people, reason):
    found = retest_agreement(np.array(first), np.array(again), np.array(people))
    assert found.reason == reason
    assert found.n == len(first)


def test_all_alike_has_a_share_but_no_kappa():
    found = retest_agreement(np.zeros(4, int), np.zeros(4, int), np.arange(4))
    assert found.equal_share == 1
    assert math.isnan(found.kappa)
