from __future__ import annotations

import warnings

import numpy as np
import pandas as pd
import pytest
from statsmodels.regression.mixed_linear_model import MixedLM

from analysis.planning.many_studies import clustered_tests, crossed_models
from analysis.stats.clustered_mean import clustered_mean


def drawn(participant_sd: float, item_sd: float, seed: int) -> np.ndarray:
    chance = np.random.default_rng(seed)
    people, items = 9, 7
    return np.asarray(
        0.3
        + participant_sd * chance.standard_normal((people, 1))
        + item_sd * chance.standard_normal((1, items))
        + chance.standard_normal((people, items))
    )


def test_balanced_studies_are_fitted_as_by_restricted_maximum_likelihood() -> None:
    scores = drawn(0.8, 0.7, 3)
    people, items = scores.shape
    table = pd.DataFrame(
        {
            "score": scores.ravel(),
            "who": np.repeat(np.arange(people), items),
            "what": np.tile(np.arange(items), people),
            "all": 1,
        }
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        oracle = MixedLM.from_formula(
            "score ~ 1",
            groups="all",
            re_formula="0",
            vc_formula={"who": "0 + C(who)", "what": "0 + C(what)"},
            data=table,
        ).fit(reml=True)

    found = crossed_models(scores[None])

    assert found.means[0] == pytest.approx(oracle.fe_params["Intercept"], abs=1e-6)
    assert found.errors[0] == pytest.approx(oracle.bse_fe["Intercept"], rel=1e-3)
    components = dict(zip(oracle.model.exog_vc.names, oracle.vcomp, strict=True))
    assert found.participant_variances[0] == pytest.approx(components["who"], rel=2e-3)
    assert found.item_variances[0] == pytest.approx(components["what"], rel=2e-3)
    assert found.residual_variances[0] == pytest.approx(oracle.scale, rel=1e-3)


def test_without_differences_between_people_it_is_the_t_test_of_items() -> None:
    from scipy import stats

    chance = np.random.default_rng(1)
    scores = drawn(0.0, 1.5, 2)
    # All participants alike on average: their mean square is zero.
    scores -= scores.mean(axis=1, keepdims=True) - chance.standard_normal()

    found = crossed_models(scores[None])

    assert found.participant_variances[0] == 0
    assert found.freedom[0] == pytest.approx(6)
    assert found.p_values[0] == pytest.approx(stats.ttest_1samp(scores.mean(axis=0), 0).pvalue)


def test_scores_that_are_all_alike_have_no_test() -> None:
    assert np.isnan(crossed_models(np.ones((1, 4, 3))).p_values[0])


def test_nothing_is_found_in_five_of_a_hundred_studies_without_a_difference() -> None:
    chance = np.random.default_rng(0)
    scores = (
        0.6 * chance.standard_normal((2000, 20, 1))
        + 0.45 * chance.standard_normal((2000, 1, 16))
        + chance.standard_normal((2000, 20, 16))
    )

    share = np.mean(crossed_models(scores).p_values < 0.05)

    assert share == pytest.approx(0.05, abs=0.015)


@pytest.mark.parametrize("density", [0.4, 1.0])
def test_many_studies_are_tested_as_each_of_them_would_be(density: float) -> None:
    chance = np.random.default_rng(5)
    shown = np.flatnonzero(chance.random(12 * 9) < density)
    people, items = shown // 9, shown % 9
    values = chance.integers(-2, 3, (40, len(shown))).astype(float)
    values[3] = 1.0
    values[4] = 0.0

    means, p_values = clustered_tests(values, people, items)

    for row, mean, p in zip(values, means, p_values, strict=True):
        alone = clustered_mean(row, people, items, null=0.0, limits=(-2.0, 2.0))
        assert mean == pytest.approx(alone.estimate)
        assert p == pytest.approx(alone.p_value, nan_ok=True)
    assert np.isnan(p_values[3:5]).all()
    assert not np.isnan(np.delete(p_values, [3, 4])).any()


def test_one_participant_and_no_answer_give_no_test() -> None:
    alone = np.zeros(3, np.intp)
    for count in (3, 0):
        _, p_values = clustered_tests(
            np.ones((2, count)) * np.arange(count), alone[:count], np.arange(count)
        )
        assert np.isnan(p_values).all()
