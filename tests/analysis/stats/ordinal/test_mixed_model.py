from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from analysis.stats.ordinal.mixed_model import OrdinalFit, RandomEffect, fit, likelihood_ratio
from motion.errors import InputError
from tests.analysis.reference import reference_ratings, with_reference
from tests.analysis.results.made_tables import pairwise_table
from tests.analysis.stats.ordinal.made_answers import MadeAnswers, made_answers


@with_reference
def test_it_agrees_with_ordinal_for_r() -> None:
    ratings, expected = reference_ratings()
    ratings = ratings.dropna()
    scores = ratings["rating"].to_numpy(int)
    covariates = {
        method: (ratings["method"] == method).to_numpy().astype(float)
        for method in ("GT", "NoAC", "NoDisc")
    }
    random = [
        RandomEffect(name=name, groups=ratings[name].to_numpy()) for name in ("participant", "item")
    ]

    mixed, without_methods = fit(scores, covariates, random), fit(scores, {}, random)

    clmm = expected["clmm"]
    assert mixed.converged
    assert not mixed.remark
    for name in covariates:
        assert mixed.estimates[name] == pytest.approx(clmm["beta"][f"method{name}"], abs=1e-4)
        assert mixed.standard_errors[name] == pytest.approx(clmm["se"][f"method{name}"], rel=1e-3)
        assert mixed.wald_p(name) == pytest.approx(clmm["p"][f"method{name}"], rel=1e-2)
    assert mixed.log_likelihood == pytest.approx(clmm["loglik"], abs=1e-4)
    assert mixed.thresholds == pytest.approx(list(clmm["theta"].values()), abs=1e-3)
    assert mixed.deviations["participant"] == pytest.approx(clmm["sd_participant"], abs=1e-3)
    assert mixed.deviations["item"] == pytest.approx(clmm["sd_item"], abs=1e-3)
    statistic, freedom, _ = likelihood_ratio(mixed, without_methods)
    assert statistic == pytest.approx(clmm["lrt_chisq_method"], abs=1e-3)
    assert freedom == 3


@pytest.mark.parametrize("size", [(8, 3), (22, 24)])
def test_a_fit_without_errors_has_the_same_likelihood(size: tuple[int, int]) -> None:
    made = made_answers(*size)

    whole = fit(made.values, {"side": made.side}, made.slopes)
    quick = fit(made.values, {"side": made.side}, made.slopes, errors=False)

    assert quick.converged
    assert quick.log_likelihood == pytest.approx(whole.log_likelihood, abs=1e-4)
    assert np.isnan(quick.standard_errors["side"])


def test_many_answers_begun_from_a_part_of_them_end_at_the_same_maximum(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = made_answers(60, 50)
    whole = fit(made.values, {"side": made.side}, made.slopes)

    monkeypatch.setattr("analysis.stats.ordinal.maximum.MANY", 1000)
    begun = fit(made.values, {"side": made.side}, made.slopes)

    assert begun.converged
    assert begun.log_likelihood == pytest.approx(whole.log_likelihood, abs=1e-5)
    assert begun.estimates["side"] == pytest.approx(whole.estimates["side"], abs=1e-4)
    assert begun.standard_errors["side"] == pytest.approx(whole.standard_errors["side"], rel=2e-3)


def test_a_variance_at_its_boundary_is_said() -> None:
    made = made_answers()
    # Two items about which everybody answers alike differ less than chance would make them.
    alike = RandomEffect(
        name="item", groups=np.repeat([0, 1], len(made.side)), multiplier=np.tile(made.side, 2)
    )

    result = fit(np.tile(made.values, 2), {"side": np.tile(made.side, 2)}, [alike])

    assert result.converged
    assert "The variance between groups of item is at its boundary" in result.remark
    assert result.standard_errors["side"] > 0


def test_separated_answers_are_said_and_have_no_p() -> None:
    made = made_answers()
    answers = np.where(made.side > 0, 4, made.values % 2)

    result = fit(answers, {"side": made.side}, made.slopes)

    assert not result.converged
    assert "separated by side" in result.remark


@pytest.mark.parametrize("answers", [[], [2, 2, 2]])
def test_nothing_to_fit_is_said(answers: list[int]) -> None:
    with pytest.raises(InputError, match="ordinal model needs"):
        fit(answers, {}, ())


def fitted(made: MadeAnswers, *, mirrored: bool = False) -> OrdinalFit:
    values, side = (4 - made.values, -made.side) if mirrored else (made.values, made.side)
    slopes = [
        RandomEffect(name=e.name, groups=e.groups, multiplier=-e.multiplier if mirrored else side)  # type: ignore[operator]
        for e in made.slopes
    ]
    return fit(values, {"side": side}, slopes)


@st.composite
def small_studies(draw: st.DrawFn) -> MadeAnswers:
    spread = st.sampled_from([0.0, 0.5, 1.5])
    made = made_answers(
        draw(st.integers(2, 7)),
        draw(st.integers(2, 7)),
        effect=draw(st.floats(-2, 2)),
        sd_participant=draw(spread),
        sd_item=draw(spread),
        seed=draw(st.integers(0, 2**20)),
    )
    assume(np.ptp(made.values) and np.ptp(made.side))
    return made


@settings(max_examples=12, deadline=None)
@given(small_studies())
def test_a_fit_converges_or_says_what_parts_the_answers_and_so_does_its_mirror_image(
    made: MadeAnswers,
) -> None:
    one, other = fitted(made), fitted(made, mirrored=True)

    for result in (one, other):
        assert result.converged or "separated" in result.remark or "Hardly any" in result.remark
        assert not result.converged or result.standard_errors["side"] > 0
    if one.converged and other.converged:
        assert other.log_likelihood == pytest.approx(one.log_likelihood, abs=0.01)


def test_a_climb_that_ends_too_early_goes_on() -> None:
    table = pairwise_table(("x", "y"), effects=(1.0, 0.0), participants=4, segments=4)
    table = table[table["kind"] != "practice"]
    side = np.where(table["right"] == "x", 1.0, -1.0)
    random = [
        RandomEffect(name=name, groups=table[name].to_numpy(str), multiplier=side)
        for name in ("participant", "segment")
    ]

    result = fit(table["response"].to_numpy(int), {"side": side}, random)
    mirrored = fit(6 - table["response"].to_numpy(int), {"side": side}, random)

    assert result.converged
    assert mirrored.estimates["side"] == pytest.approx(-result.estimates["side"], abs=1e-3)


def test_a_deviation_does_not_stay_at_zero_where_the_answers_say_otherwise() -> None:
    """The climb from the usual start ends with participants alike, although they differ."""
    chance = np.random.default_rng(129)
    people, items = (int(chance.integers(2, 8)) for _ in range(2))
    effect = chance.normal(0, 1)
    taste = chance.normal(0, chance.choice([0, 0.5, 1.5]), people)
    luck = chance.normal(0, chance.choice([0, 0.5, 1.5]), items)
    who, what = np.repeat(np.arange(people), items), np.tile(np.arange(items), people)
    side = chance.choice([-1.0, 1.0], people * items)
    latent = side * (effect + taste[who] + luck[what]) + chance.logistic(size=people * items)
    values = np.digitize(latent, (-1.6, -0.45, 0.45, 1.6))

    result = fitted(MadeAnswers(values, side, who, what))

    assert fitted(MadeAnswers(values, side, who, what), mirrored=True).log_likelihood == (
        pytest.approx(result.log_likelihood, abs=1e-4)
    )
    assert result.deviations["participant"] > 0.1
