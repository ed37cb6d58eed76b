from __future__ import annotations

import warnings

import numpy as np
import pandas as pd
import pytest
from statsmodels.regression.mixed_linear_model import MixedLM

from analysis.planning.deciding_tests import Company, Findings, decided_by_holm, right
from analysis.planning.many_studies import clustered_tests, crossed_models
from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.multiple_testing import holm


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


def test_a_block_alone_is_corrected_within_itself() -> None:
    p_values = np.array([[0.01, 0.04, 0.2], [0.03, 0.02, 0.04]])

    decided = decided_by_holm(p_values, Company(pools=(p_values,), counts=(0,)), 1)

    for row, own in zip(p_values, decided, strict=True):
        assert (own > 0).tolist() == [p < 0.05 for p in holm(row.tolist())]


def test_in_the_company_of_nothing_a_block_must_be_far_surer() -> None:
    nothing = np.full((10, 1), 0.9)
    company = Company(pools=(nothing,), counts=(4,))

    decided = decided_by_holm(np.array([[0.02], [0.009]]), company, 1)

    assert decided.ravel().tolist() == [0.0, 1.0]


def test_in_the_company_of_what_decides_a_block_is_hardly_corrected() -> None:
    sure = np.full((10, 1), 1e-6)
    company = Company(pools=(sure,), counts=(4,))

    assert decided_by_holm(np.array([[0.04]]), company, 1)[0, 0] == 1.0


def test_a_difference_counts_as_found_where_the_better_one_comes_out_ahead() -> None:
    tested = Findings(p_values=np.zeros((2, 2)), signs=np.array([[1.0, 1.0], [-1.0, 1.0]]))
    decided = np.ones((2, 2))

    assert right(tested, decided, (True, False), effect=0.4).tolist() == [1.0, 0.0]
    assert right(tested, decided, (True, False), effect=0.0).tolist() == [1.0, 1.0]


def test_tests_that_cannot_be_made_never_decide() -> None:
    p_values = np.array([[np.nan, 0.001]])

    decided = decided_by_holm(p_values, Company(pools=(p_values,), counts=(0,)), 1)

    assert decided.tolist() == [[0.0, 1.0]]


def test_the_same_seed_draws_the_same_companies() -> None:
    chance = np.random.default_rng(2)
    pool = chance.random((50, 2)) / 10
    company = Company(pools=(pool,), counts=(3,))

    first, again = (decided_by_holm(pool, company, 7) for _ in range(2))

    assert first == pytest.approx(again)
    assert set(np.unique(first)) - {0.0, 1.0}
