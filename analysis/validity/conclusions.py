"""What the report would conclude from simulated studies, and what is true of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from analysis.ordinal.mixed_model import OrdinalFit, RandomEffect, fit, likelihood_ratio
from analysis.preferences.clustered import ClusteredMean, clustered_mean
from analysis.published.pooled import pooled_tests
from analysis.rankings.friedman import Blocks, friedman
from analysis.ratings.contrasts import contrasts
from analysis.robustness.min_f import min_f
from analysis.robustness.participant_means import group_means
from analysis.robustness.wilcoxon import signed_rank
from analysis.strengths.bradley_terry import Votes, bradley_terry
from analysis.strengths.plackett_luce import plackett_luce
from analysis.validity.studies import (
    Design,
    Judgements,
    judgements,
    preferences,
    ranks,
    ratings,
    true_outcomes,
    true_rating_difference,
    true_win_share,
    votes,
)

Z_95: Final = float(stats.norm.ppf(0.975))

VOTED: Final = ("a", "b", "c", "d")
RANKED: Final = ("a", "b", "c", "d", "e")
RATED: Final = ("a", "b", "c")

SETTLED: Final = 20_000
"""Rankings from which a truth without a formula is taken."""

EXPECTED: Final = 3_000
"""Votes for each two conditions, divided as they are expected, from which another is taken."""


@dataclass(frozen=True, kw_only=True)
class Conclusion:
    """A number of one study's report.

    Attributes
    ----------
    p_value : float
        Of there being no effect; NaN where the report gives none.
    low, high : float
        Ends of the 95 % interval; NaN where the report gives none.
    """

    p_value: float
    low: float = math.nan
    high: float = math.nan


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """A kind of study.

    Attributes
    ----------
    conclude : callable
        Simulates one study of a design and returns its conclusions by name.
    truths : callable
        From a design to what is true, by the names of the conclusions that have intervals.
    naive : tuple of str
        Those conclusions that treat answers as independent, as papers do.
    """

    conclude: Callable[[Design, np.random.Generator], Mapping[str, Conclusion]]
    truths: Callable[[Design], Mapping[str, float]]
    naive: tuple[str, ...]


def conclude_preferences(
    design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    """Return the conclusions about one comparison."""
    study = preferences(design, generator)
    values = study.towards_first.astype(np.float64)
    pooled = pooled_tests(study.towards_first)
    random = [
        RandomEffect(name=name, groups=groups, multiplier=study.side)
        for name, groups in (("participant", study.participants), ("item", study.items))
    ]
    # Responses count towards the right; where the first condition stands there, side is 1.
    full = fit(study.responses, {"side": study.side}, random)
    reduced = fit(study.responses, {}, random, errors=False)
    wald = _wald(full, "side")
    return {
        "win share, two-way clustered": _of_mean(
            clustered_mean(study.wins, study.participants, study.items)
        ),
        "clmm, likelihood ratio": Conclusion(p_value=_likelihood_ratio_p(full, reduced)),
        "clmm, Wald": wald,
        "min F'": Conclusion(p_value=min_f(values, study.participants, study.items).p_value),
        "Wilcoxon on participant means": Conclusion(
            p_value=signed_rank(group_means(values, study.participants)).p_value
        ),
        "pooled binomial": Conclusion(p_value=pooled.binomial.p_value),
        "pooled Wilcoxon": Conclusion(p_value=pooled.wilcoxon.p_value),
    }


def conclude_ratings(design: Design, generator: np.random.Generator) -> Mapping[str, Conclusion]:
    """Return the conclusions about the first two of rated conditions that differ in taste."""
    return _of_ratings(judgements(design, len(RATED), generator), design, generator)


def conclude_agreed_ratings(
    design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    """Return the same where participants and items differ in level only."""
    judged = judgements(design, len(RATED), generator, tastes=False)
    return _of_ratings(judged, design, generator)


def conclude_votes(design: Design, generator: np.random.Generator) -> Mapping[str, Conclusion]:
    """Return the conclusions about the first two of several conditions shown in pairs."""
    judged = judgements(design, len(VOTED), generator)
    left, right, outcome = votes(judged, generator)
    found = bradley_terry(
        Votes(
            conditions=VOTED,
            left=left,
            right=right,
            outcome=outcome,
            participant=judged.participants,
        )
    )
    return {
        "Bradley-Terry, clustered by participant": _normal(found.strengths[0], found.errors[0]),
        "Bradley-Terry, errors of the model": _normal(found.strengths[0], found.errors_by_model[0]),
    }


def conclude_rankings(design: Design, generator: np.random.Generator) -> Mapping[str, Conclusion]:
    """Return the conclusions about ranked conditions."""
    judged = judgements(design, len(RANKED), generator)
    placed = ranks(judged, generator)
    found = plackett_luce(_rankings(placed, judged.participants), conditions=RANKED)
    goodness = (1 + len(RANKED) - placed).astype(np.float64)
    by_person = np.column_stack([group_means(column, judged.participants) for column in goodness.T])
    return {
        "Plackett-Luce, clustered by participant": _normal(found.worths[0], found.errors[0]),
        "Friedman on participant means": Conclusion(
            p_value=friedman(Blocks(conditions=RANKED, means=by_person)).p_value
        ),
        "Plackett-Luce, errors of the model": _normal(found.worths[0], found.errors_by_model[0]),
        "Friedman on all rankings": Conclusion(
            p_value=friedman(Blocks(conditions=RANKED, means=goodness)).p_value
        ),
    }


def _of_ratings(
    judged: Judgements, design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    given = ratings(judged, design, generator)
    first, second = given[:, 0], given[:, 1]
    condition = np.tile(np.arange(len(RATED)), len(given))
    covariates = {
        name: (condition == number).astype(np.float64)
        for number, name in enumerate(RATED)
        if number != 1
    }
    random = [
        RandomEffect(name=name, groups=np.repeat(groups, len(RATED)))
        for name, groups in (("participant", judged.participants), ("item", judged.items))
    ]
    found = contrasts(fit(given.ravel(), covariates, random), RATED)[0]
    differences = (first - second).astype(np.float64)
    return {
        "rating contrast by clmm": Conclusion(
            p_value=found.p_value, low=found.low, high=found.high
        ),
        "rating difference, two-way clustered": _of_mean(
            clustered_mean(
                differences, judged.participants, judged.items, null=0.0, limits=(-4.0, 4.0)
            )
        ),
        "pooled Wilcoxon of ratings": Conclusion(p_value=signed_rank(differences).normal_p),
    }


def _truths_of_preferences(design: Design) -> Mapping[str, float]:
    return {"win share, two-way clustered": true_win_share(design), "clmm, Wald": design.effect}


def _truths_of_ratings(design: Design) -> Mapping[str, float]:
    return {
        "rating contrast by clmm": design.effect,
        "rating difference, two-way clustered": true_rating_difference(design),
    }


def _truths_of_agreed_ratings(design: Design) -> Mapping[str, float]:
    return {
        "rating contrast by clmm": design.effect,
        "rating difference, two-way clustered": true_rating_difference(design, tastes=False),
    }


def _truths_of_votes(design: Design) -> Mapping[str, float]:
    """Return what the strengths tend to as participants and items become many."""
    rows = []
    for left in range(len(VOTED)):
        for right in range(len(VOTED)):
            if left != right:
                effect = design.effect * ((left == 0) - (right == 0))
                shares = true_outcomes(replace(design, effect=effect))
                counts = np.rint(EXPECTED * np.array(shares)).astype(np.intp)
                rows.append(np.repeat([[left, right, won] for won in (1, 0, -1)], counts, axis=0))
    every = np.concatenate(rows)
    found = bradley_terry(
        Votes(
            conditions=VOTED,
            left=every[:, 0],
            right=every[:, 1],
            outcome=every[:, 2],
            participant=np.arange(len(every)),
        )
    )
    strength = float(found.strengths[0])
    return {
        "Bradley-Terry, clustered by participant": strength,
        "Bradley-Terry, errors of the model": strength,
    }


def _truths_of_rankings(design: Design) -> Mapping[str, float]:
    """Return what the worths tend to as participants and items become many."""
    worth = 0.0
    if design.effect:
        generator = np.random.default_rng(0)
        # Everybody ranks once, about an item of their own.
        alone = replace(design, participants=SETTLED, items=1)
        alone = replace(alone, participant_sd=design.spread, item_sd=0.0)
        judged = judgements(alone, len(RANKED), generator)
        table = _rankings(ranks(judged, generator), judged.participants)
        worth = float(plackett_luce(table, conditions=RANKED).worths[0])
    return {
        "Plackett-Luce, clustered by participant": worth,
        "Plackett-Luce, errors of the model": worth,
    }


PREFERENCES: Final = Protocol(
    conclude=conclude_preferences,
    truths=_truths_of_preferences,
    naive=("pooled binomial", "pooled Wilcoxon"),
)
RATINGS: Final = Protocol(
    conclude=conclude_ratings, truths=_truths_of_ratings, naive=("pooled Wilcoxon of ratings",)
)
AGREED_RATINGS: Final = Protocol(
    conclude=conclude_agreed_ratings,
    truths=_truths_of_agreed_ratings,
    naive=("pooled Wilcoxon of ratings",),
)
VOTES: Final = Protocol(
    conclude=conclude_votes,
    truths=_truths_of_votes,
    naive=("Bradley-Terry, errors of the model",),
)
RANKINGS: Final = Protocol(
    conclude=conclude_rankings,
    truths=_truths_of_rankings,
    naive=("Plackett-Luce, errors of the model", "Friedman on all rankings"),
)


def _of_mean(found: ClusteredMean) -> Conclusion:
    return Conclusion(p_value=found.p_value, low=found.low, high=found.high)


def _normal(estimate: float, error: float) -> Conclusion:
    if not error > 0:
        return Conclusion(p_value=math.nan)
    return Conclusion(
        p_value=float(2 * stats.norm.sf(abs(estimate) / error)),
        low=float(estimate - Z_95 * error),
        high=float(estimate + Z_95 * error),
    )


def _wald(found: OrdinalFit, name: str) -> Conclusion:
    return _normal(found.estimates[name], found.standard_errors[name])


def _likelihood_ratio_p(full: OrdinalFit, reduced: OrdinalFit) -> float:
    converged = full.converged and reduced.converged
    return likelihood_ratio(full, reduced)[2] if converged else math.nan


def _rankings(placed: NDArray[np.intp], participants: NDArray[np.intp]) -> pd.DataFrame:
    """Return rankings, shape (N, conditions), as a table with one row for each place."""
    count, width = placed.shape
    return pd.DataFrame(
        {
            "ranking": np.repeat(np.arange(count), width),
            "participant": np.repeat(participants, width),
            "condition": np.tile(RANKED, count),
            "rank": placed.ravel(),
        }
    )
