"""The cumulative link mixed model: fitting it, and remarks on when not to trust it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.ordinal.crossed import Layout
from analysis.stats.ordinal.laplace import Answers, Likelihood, Thresholds
from analysis.stats.ordinal.maximum import BOUNDARY, LARGEST, free_parameters, maximum
from motion.arrays import Floats
from motion.errors import InputError

LARGE: Final = 6.0
"""A larger effect that is smaller than its error has no finite estimate either, nor has a larger
effect or deviation if no maximum was reached."""


@dataclass(frozen=True, kw_only=True)
class RandomEffect:
    """A grouping of the answers whose groups differ at random.

    Attributes
    ----------
    name : str
        Its name in the result.
    groups : ndarray, shape (N,)
        Label of each answer's group.
    multiplier : ndarray, shape (N,), or None
        Multiplier of the group's effect in each answer (a random slope); None for 1 (a random
        intercept).
    """

    name: str
    groups: NDArray[np.generic]
    multiplier: Floats | None = None


@dataclass(frozen=True, kw_only=True)
class OrdinalFit:
    """A fitted cumulative link mixed model.

    Attributes
    ----------
    estimates, standard_errors : mapping of covariate to float
        Fixed effects on the latent scale; the error is NaN if the model did not converge, or no
        errors were requested.
    thresholds : tuple of float
        In order.
    deviations : mapping of random effect to float
        Standard deviations.
    log_likelihood : float
        By Laplace's approximation.
    parameters : int
        Number of estimated parameters.
    converged : bool
        Whether a maximum was reached.
    remark : str
        Why the result must not be used, or a caution about it; empty if there is none.
    """

    estimates: Mapping[str, float]
    standard_errors: Mapping[str, float]
    thresholds: tuple[float, ...]
    deviations: Mapping[str, float]
    log_likelihood: float
    parameters: int
    converged: bool
    remark: str

    def wald_p(self, name: str) -> float:
        """Return the two-sided Wald p of the fixed effect `name`."""
        return float(2 * stats.norm.sf(abs(self.estimates[name]) / self.standard_errors[name]))


def fit(
    answers: Sequence[int] | NDArray[np.integer],
    covariates: Mapping[str, Sequence[float] | Floats],
    random: Sequence[RandomEffect],
    *,
    errors: bool = True,
) -> OrdinalFit:
    """Fit a cumulative link mixed model by Laplace's approximation.

    P(answer <= k) = logistic(threshold_k - eta), eta = covariates' effects + one random effect for
    each grouping, normal and independent (Agresti 2010; Christensen, `ordinal` for R).

    Parameters
    ----------
    answers : sequence of int, shape (N,)
        Ordered categories; unused ones are dropped.
    covariates : mapping of name to sequence, shape (N,)
        Fixed effects, without an intercept; linearly independent.
    random : sequence of RandomEffect
        Crossed random effects, at least one.
    errors : bool
        Whether to compute standard errors. A model used only for comparison with another needs
        none, and is fitted in half the time.

    Raises
    ------
    InputError
        If there are no answers, or all are alike.
    """
    data, ordered = _data(answers, covariates, random)
    return _result(data, list(covariates), ordered, *maximum(data, curved=errors))


def _data(
    answers: Sequence[int] | NDArray[np.integer],
    covariates: Mapping[str, Sequence[float] | Floats],
    random: Sequence[RandomEffect],
) -> tuple[Answers, list[RandomEffect]]:
    """Return the data as numbers, and the random effects, the largest first."""
    categories, codes = np.unique(np.asarray(answers), return_inverse=True)
    if len(categories) < 2:
        raise InputError(
            "an ordinal model needs two different answers"
            if len(codes)
            else "an ordinal model needs answers",
            remedy="Collect more answers",
        )
    fixed = np.column_stack(
        [np.asarray(values, np.float64) for values in covariates.values()]
        or [np.empty((len(codes), 0))]
    )
    ordered = sorted(random, key=lambda effect: -len(np.unique(effect.groups)))
    groups = [np.unique(effect.groups, return_inverse=True)[1] for effect in ordered]
    data = Answers(
        codes=codes.astype(np.intp),
        thresholds=Thresholds(len(categories)),
        fixed=fixed,
        layout=Layout(tuple(groups), tuple(int(codes.max()) + 1 for codes in groups)),
        multipliers=tuple(
            np.ones(len(codes)) if effect.multiplier is None else effect.multiplier
            for effect in ordered
        ),
    )
    return data, ordered


def likelihood_ratio(full: OrdinalFit, reduced: OrdinalFit) -> tuple[float, int, float]:
    """Compare two nested fits: the statistic, its degrees of freedom and the p value."""
    statistic = max(0.0, 2 * (full.log_likelihood - reduced.log_likelihood))
    freedom = full.parameters - reduced.parameters
    return statistic, freedom, float(stats.chi2.sf(statistic, freedom))


def _result(
    answers: Answers,
    names: Sequence[str],
    random: Sequence[RandomEffect],
    parameters: Floats,
    likelihood: Likelihood,
    curvature: Floats | None,
    converged: bool,
) -> OrdinalFit:
    free, effects, deviations = answers.split(parameters)
    inside = free_parameters(answers, parameters)
    covariance = np.full((len(parameters), len(parameters)), math.nan)
    if converged and curvature is not None:
        covariance[np.ix_(inside, inside)] = np.linalg.inv(curvature[np.ix_(inside, inside)])
    of_effects = slice(len(free), len(free) + len(names))
    errors = np.sqrt(np.diagonal(covariance)[of_effects])
    zero = tuple(
        effect.name for effect, sd in zip(random, deviations, strict=True) if abs(sd) < BOUNDARY
    )
    most = LARGEST if converged else LARGE
    separated = [
        name
        for name, b, error in zip(names, effects, errors, strict=True)
        if abs(b) > most or error > abs(b) > LARGE
    ]
    diverging = [
        effect.name for effect, sd in zip(random, deviations, strict=True) if abs(sd) > most
    ]
    return OrdinalFit(
        estimates=dict(zip(names, effects.tolist(), strict=True)),
        standard_errors=dict(zip(names, errors.tolist(), strict=True)),
        thresholds=tuple(answers.thresholds.values(free).tolist()),
        deviations={e.name: abs(float(s)) for e, s in zip(random, deviations, strict=True)},
        log_likelihood=likelihood.value,
        parameters=answers.count,
        converged=converged and not separated and not diverging,
        remark=_remark(
            converged,
            # Effects grow with the variance between groups if it is the variance that diverges.
            []
            if diverging and np.abs(deviations).max() > np.abs(effects).max(initial=0.0)
            else separated,
            diverging,
            zero,
        ),
    )


def _remark(
    converged: bool, separated: Sequence[str], diverging: Sequence[str], zero: Sequence[str]
) -> str:
    if separated:
        return (
            f"The answers are separated by {', '.join(separated)}: the effect has no finite "
            "estimate, and its standard error means nothing."
        )
    if diverging:
        return (
            f"Hardly any answers differ within a {' or a '.join(diverging)}, as may happen in "
            "small tables: the variance between them, and so the model, has no finite estimate."
        )
    if not converged:
        return "The model did not converge: its estimates must not be used."
    if zero:
        names = " and that between ".join(f"{name}s" for name in zero)
        return f"The variance between {names} is estimated as zero."
    return ""
