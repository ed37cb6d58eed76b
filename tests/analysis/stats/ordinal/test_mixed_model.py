from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import expit
from scipy.stats import logistic

from analysis.stats.ordinal.crossed import Information, Layout
from analysis.stats.ordinal.laplace import Answers, Interval, Thresholds, likelihood
from analysis.stats.ordinal.mixed_model import OrdinalFit, RandomEffect, fit, likelihood_ratio
from motion.arrays import Floats, Indices
from motion.errors import InputError
from tests.analysis.reference import reference_ratings, with_reference

THRESHOLDS = (-1.6, -0.45, 0.45, 1.6)


@dataclass(frozen=True)
class MadeAnswers:
    values: Indices
    side: Floats
    participants: Indices
    items: Indices

    @property
    def slopes(self) -> tuple[RandomEffect, RandomEffect]:
        """Return participants and items that differ in their preference."""
        return (
            RandomEffect(name="participant", groups=self.participants, multiplier=self.side),
            RandomEffect(name="item", groups=self.items, multiplier=self.side),
        )


def made_answers(
    participants: int = 20,
    items: int = 12,
    *,
    effect: float = 0.4,
    sd_participant: float = 0.6,
    sd_item: float = 0.45,
    seed: int = 1,
) -> MadeAnswers:
    chance = np.random.default_rng(seed)
    who, what = np.divmod(np.arange(participants * items), items)
    side = chance.choice([-1.0, 1.0], len(who))
    taste = effect + chance.normal(0, sd_participant, participants)[who]
    taste += chance.normal(0, sd_item, items)[what]
    latent = side * taste + chance.logistic(size=len(who))
    return MadeAnswers(np.digitize(latent, THRESHOLDS), side, who, what)


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
def test_skipping_standard_errors_keeps_the_likelihood(size: tuple[int, int]) -> None:
    made = made_answers(*size)

    whole = fitted(made)
    quick = fit(made.values, {"side": made.side}, made.slopes, errors=False)

    assert quick.converged
    assert quick.log_likelihood == pytest.approx(whole.log_likelihood, abs=1e-4)
    assert np.isnan(quick.standard_errors["side"])


@pytest.mark.parametrize("every", [2, 3, 20])
def test_starting_where_a_part_of_the_answers_leads_ends_at_the_same_maximum(
    monkeypatch: pytest.MonkeyPatch, every: int
) -> None:
    made = made_answers(60, 40)
    usual = fitted(made)
    monkeypatch.setattr("analysis.stats.ordinal.maximum.MANY", 0)
    monkeypatch.setattr("analysis.stats.ordinal.maximum.EVERY", every)

    result = fitted(made)

    assert result.converged
    assert result.log_likelihood == pytest.approx(usual.log_likelihood, abs=1e-6)
    assert result.estimates == pytest.approx(usual.estimates, abs=1e-4)
    assert result.standard_errors == pytest.approx(usual.standard_errors, abs=1e-4)


def test_a_variance_at_its_boundary_is_reported() -> None:
    made = made_answers()
    # Two items with identical answers differ less than by chance.
    alike = RandomEffect(
        name="item", groups=np.repeat([0, 1], len(made.side)), multiplier=np.tile(made.side, 2)
    )

    result = fit(np.tile(made.values, 2), {"side": np.tile(made.side, 2)}, [alike])

    assert result.converged
    assert "The variance between items is estimated as zero" in result.remark
    assert result.standard_errors["side"] > 0


def test_separated_answers_are_reported_without_a_p_value() -> None:
    made = made_answers()
    answers = np.where(made.side > 0, 4, made.values % 2)

    result = fit(answers, {"side": made.side}, made.slopes)

    assert not result.converged
    assert "separated by side" in result.remark


@pytest.mark.parametrize("answers", [[], [2, 2, 2]])
def test_an_empty_fit_has_a_reason(answers: list[int]) -> None:
    with pytest.raises(InputError, match="ordinal model needs"):
        fit(answers, {}, ())


def fitted(made: MadeAnswers) -> OrdinalFit:
    return fit(made.values, {"side": made.side}, made.slopes)


def mirror_image(made: MadeAnswers) -> MadeAnswers:
    return replace(made, values=4 - made.values)


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
def test_a_fit_and_its_mirror_image_converge_or_report_separation(made: MadeAnswers) -> None:
    one, other = fitted(made), fitted(mirror_image(made))

    for result in (one, other):
        assert result.converged or "separated" in result.remark or "Hardly any" in result.remark
        assert not result.converged or result.standard_errors["side"] > 0
    if one.converged and other.converged:
        assert other.log_likelihood == pytest.approx(one.log_likelihood, abs=0.01)


@pytest.mark.parametrize(("participants", "items", "seed"), [(7, 5, 224), (4, 7, 120)])
def test_an_optimisation_that_stops_early_or_at_zero_deviation_is_continued(
    participants: int, items: int, seed: int
) -> None:
    """From the usual start, the first climb ends below the maximum, with items nearly alike."""
    made = made_answers(participants, items, effect=1.0, sd_participant=1.5, sd_item=0.5, seed=seed)

    result = fitted(made)

    assert result.converged
    assert result.deviations["item"] > 0.1
    assert fitted(mirror_image(made)).log_likelihood == pytest.approx(
        result.log_likelihood, abs=1e-4
    )


def test_the_gradient_is_the_derivative() -> None:
    made = made_answers()
    answers = Answers(
        codes=made.values,
        thresholds=Thresholds(5),
        fixed=made.side[:, None],
        layout=Layout((made.participants, made.participants, made.items), (20, 20, 12)),
        multipliers=(made.side, np.ones_like(made.side), made.side),
    )
    at = np.random.default_rng(2).normal(0, 0.4, answers.count)

    numeric = [
        (likelihood(answers, at + e).value - likelihood(answers, at - e).value) / 2e-5
        for e in 1e-5 * np.eye(answers.count)
    ]

    np.testing.assert_allclose(likelihood(answers, at).gradient, numeric, rtol=1e-5, atol=1e-5)


def test_the_approximation_is_near_the_exact_integral() -> None:
    codes = np.array([0, 1, 1, 0, 1, 1, 1, 0] * 5)
    layout = Layout((np.zeros(40, int),), (1,))
    made = Answers(codes, Thresholds(2), np.empty((40, 0)), layout, (np.ones(40),))

    def density(u: float) -> float:
        right = expit(np.where(codes == 1, u * 0.7 - 0.2, 0.2 - u * 0.7))
        return float(np.prod(right) * np.exp(-0.5 * u * u) / np.sqrt(2 * np.pi))

    exact = np.log(quad(density, -8, 8)[0])
    assert likelihood(made, np.array([0.2, 0.7])).value == pytest.approx(exact, abs=0.02)


@pytest.mark.parametrize("sizes", [(7,), (7, 4, 3)])
def test_the_information_agrees_with_the_full_matrix(sizes: tuple[int, ...]) -> None:
    chance = np.random.default_rng(3)
    groups = tuple(chance.integers(0, size, 60) for size in sizes)
    multipliers = [chance.normal(size=60) for _ in sizes]
    weights = chance.uniform(0.1, 1, 60)
    design = np.concatenate(
        [m[:, None] * np.eye(k)[g] for m, k, g in zip(multipliers, sizes, groups, strict=True)],
        axis=1,
    )
    matrix = np.eye(sum(sizes)) + design.T @ (weights[:, None] * design)
    right = chance.normal(size=sum(sizes))

    information = Information.of(Layout(groups, sizes), multipliers, weights)

    np.testing.assert_allclose(information.log_determinant, np.linalg.slogdet(matrix)[1])
    np.testing.assert_allclose(information.solve(right), np.linalg.solve(matrix, right))
    variances = sum(
        m * d for m, d in zip(multipliers, information.directions(multipliers), strict=True)
    )
    expected = np.einsum("ij,jk,ik->i", design, np.linalg.inv(matrix), design)
    np.testing.assert_allclose(variances, expected)


@pytest.mark.parametrize("far", [-30.0, 30.0])
def test_probabilities_of_extreme_intervals_stay_accurate(far: float) -> None:
    low, high = sorted((-abs(far), -abs(far) + np.sign(-far)))

    result = Interval(np.array([far]), np.array([far + 1]))

    expected = np.log(logistic.cdf(high) - logistic.cdf(low))
    np.testing.assert_allclose(result.log_probability, expected, rtol=1e-9)
