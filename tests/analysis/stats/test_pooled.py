from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from analysis.stats.wilcoxon import pooled_tests


def test_it_is_what_the_plain_tests_give():
    answers = np.random.default_rng(1).integers(-2, 3, 600)
    found = pooled_tests(answers)
    wins, losses = int((answers > 0).sum()), int((answers < 0).sum())
    assert found.binomial_p == pytest.approx(stats.binomtest(wins, wins + losses).pvalue)
    plain = stats.wilcoxon(answers.astype(float), correction=False, method="asymptotic")
    assert found.wilcoxon_p == pytest.approx(plain.pvalue)


def test_it_says_what_it_ignores():
    ignored = " ".join(pooled_tests(np.array([1, -1])).ignores)
    assert all(word in ignored for word in ("participant", "segment", "several tests", "no diff"))


def test_it_finds_what_is_not_there_where_participants_differ():
    generator = np.random.default_rng(2)

    def study() -> np.ndarray:
        latent = (
            generator.normal(0, 0.6, (22, 1))
            + generator.normal(0, 0.45, (1, 24))
            + generator.logistic(size=(22, 24))
        )
        return (np.sign(latent) * np.digitize(np.abs(latent), [0.45, 1.6])).ravel()

    found = [pooled_tests(study()).wilcoxon_p for _ in range(100)]
    assert np.mean(np.array(found) < 0.05) > 0.15


@pytest.mark.parametrize(
    ("answers", "reason"), [([], "no values"), ([0, 0], "all values are zero")]
)
def test_no_test_comes_with_its_reason(answers, reason):
    found = pooled_tests(np.array(answers))
    assert found.reason == reason
    assert math.isnan(found.binomial_p)
    assert math.isnan(found.wilcoxon_p)
