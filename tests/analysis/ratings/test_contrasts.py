from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analysis.ordinal.mixed_model import RandomEffect, fit
from analysis.ratings.contrasts import contrasts, effects_around_the_average, tukey_p
from tests.analysis.ratings.made_ratings import CONDITIONS, made_ratings
from tests.analysis.reference import reference_ratings, with_reference


def fitted(ratings, conditions, *, reference, random=True, link="logit"):
    covariates = {
        name: (ratings["condition"] == name).to_numpy(float)
        for name in conditions
        if name != reference
    }
    effects = [
        RandomEffect(name=name, groups=ratings[name].to_numpy(str))
        for name in ("participant", "segment")
    ]
    return fit(ratings["value"].to_numpy(int), covariates, effects if random else [], link=link)


@pytest.fixture(scope="module")
def made():
    return made_ratings()


@with_reference
def test_they_agree_with_emmeans_for_r():
    ratings, reference = reference_ratings()
    tidy = ratings.rename(columns={"item": "segment", "method": "condition", "rating": "value"})
    order = ["Ours", "GT", "NoAC", "NoDisc"]

    found = contrasts(fitted(tidy, order, reference="Ours"), order)

    names = ("pairs_unadjusted", "holm", "tukey")
    rows = zip(found, *(reference[f"emmeans_{name}"] for name in names), strict=True)
    for contrast, plain, holm, tukey in rows:
        assert f"{contrast.a} - {contrast.b}" == plain["contrast"] == holm["contrast"]
        assert contrast.estimate == pytest.approx(plain["estimate"], abs=1e-4)
        assert contrast.standard_error == pytest.approx(plain["SE"], abs=1e-4)
        assert contrast.p_value == pytest.approx(plain["p.value"], rel=2e-2)
        assert contrast.holm_p == pytest.approx(holm["p.value"], rel=2e-2)
        assert tukey_p(contrast, 4) == pytest.approx(tukey["p.value"], rel=2e-2)
        assert contrast.odds_ratio == pytest.approx(math.exp(plain["estimate"]), rel=1e-3)


def test_which_condition_the_model_refers_to_does_not_matter(made):
    first = contrasts(fitted(made, CONDITIONS, reference="ours", random=False), CONDITIONS)
    last = contrasts(fitted(made, CONDITIONS, reference="static", random=False), CONDITIONS)
    for one, other in zip(first, last, strict=True):
        assert (one.a, one.b) == (other.a, other.b)
        assert one.estimate == pytest.approx(other.estimate, abs=1e-4)
        assert one.standard_error == pytest.approx(other.standard_error, rel=1e-3)


def test_odds_ratios_and_intervals_belong_to_the_estimate(made):
    for contrast in contrasts(fitted(made, CONDITIONS, reference="other"), CONDITIONS):
        assert contrast.low < contrast.estimate < contrast.high
        assert contrast.odds_ratio == pytest.approx(math.exp(contrast.estimate))
        assert contrast.odds_low == pytest.approx(math.exp(contrast.low))
        assert contrast.holm_p >= contrast.p_value
        assert contrast.answers == len(made)


def test_effects_around_the_average_add_up_to_zero_and_differ_by_the_contrasts(made):
    model = fitted(made, CONDITIONS, reference="ours", random=False)
    around = effects_around_the_average(model, CONDITIONS)
    assert sum(effect.estimate for effect in around) == pytest.approx(0, abs=1e-9)
    assert around[0].estimate - around[1].estimate == pytest.approx(
        contrasts(model, CONDITIONS)[0].estimate
    )
    assert [effect.b for effect in around] == ["", "", ""]


def test_a_probit_model_has_no_odds(made):
    model = fitted(made, CONDITIONS, reference="ours", random=False, link="probit")
    assert all(math.isnan(contrast.odds_ratio) for contrast in contrasts(model, CONDITIONS))


def test_a_model_that_did_not_converge_says_so_instead_of_numbers(made):
    model = fitted(made, CONDITIONS, reference="ours", random=False)
    failed = replace(model, converged=False, remark="The model did not converge.")
    for contrast in contrasts(failed, CONDITIONS):
        assert contrast.remark == "The model did not converge."
        assert np.isnan([contrast.estimate, contrast.p_value, contrast.holm_p]).all()


def test_a_model_of_other_conditions_is_refused(made):
    model = fitted(made, CONDITIONS, reference="ours", random=False)
    with pytest.raises(ValueError, match="each condition but one"):
        contrasts(model, ("ours", "other"))
