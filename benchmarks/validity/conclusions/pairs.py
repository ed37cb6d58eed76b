"""Conclusions about one comparison of two conditions."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.f_tests import between_groups, between_segments, min_f
from analysis.stats.one_sample_tests import equivalence, pooled_tests, sign_test, signed_rank
from analysis.stats.ordinal.mixed_model import OrdinalFit, RandomEffect, fit, likelihood_ratio
from analysis.stats.samples import group_means
from benchmarks.validity.conclusions.conclusion import (
    EFFECT,
    Conclusion,
    Protocol,
    no_truths,
    of_error,
    of_mean,
)
from benchmarks.validity.studies import Design, preferences, true_win_share

WIN_SHARE: Final = "win share, two-way clustered"
LEFT_SHARE: Final = "left side's share, two-way clustered"
OWN_SHARE: Final = "own speech's win share, two-way clustered"
EQUIVALENT: Final = "two one-sided tests of the win share"
EMOTIONS: Final = 8
BY_EMOTION: Final = "emotions differ, min F'"
BY_SEGMENT: Final = "segments differ, F"
RATIO: Final = "clmm, likelihood ratio"
WALD: Final = "clmm, Wald"


def conclude_preferences(
    design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    """Return the conclusions without a model."""
    study = preferences(design, generator)
    values = study.towards_first.astype(np.float64)
    by_person = group_means(values, study.participants)
    pooled = pooled_tests(study.towards_first)
    left = (1 - np.sign(study.responses - 3)) / 2
    return {
        WIN_SHARE: of_mean(clustered_mean(study.wins, study.participants, study.items)),
        LEFT_SHARE: of_mean(clustered_mean(left, study.participants, study.items)),
        "min F'": Conclusion(p_value=min_f(values, study.participants, study.items).p_value),
        "sign test on participant means": Conclusion(p_value=sign_test(by_person).p_value),
        "Wilcoxon on participant means": Conclusion(p_value=signed_rank(by_person).p_value),
        "pooled binomial": Conclusion(p_value=pooled.binomial_p),
        "pooled Wilcoxon": Conclusion(p_value=pooled.wilcoxon_p),
    }


def conclude_net_preference(
    design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    """Return the mixed model's conclusions, with answers counted towards the right."""
    study = preferences(design, generator)
    random = [
        RandomEffect(name=name, groups=groups, multiplier=study.side)
        for name, groups in (("participant", study.participants), ("item", study.items))
    ]
    full = fit(study.responses, {"side": study.side}, random)
    reduced = fit(study.responses, {}, random, errors=False)
    wald = of_error(full.estimates["side"], full.standard_errors["side"])
    return {RATIO: Conclusion(p_value=_likelihood_ratio_p(full, reduced)), WALD: wald}


def conclude_mismatch(design: Design, generator: np.random.Generator) -> Mapping[str, Conclusion]:
    """Return how much better a motion's own speech is found to fit than another's."""
    study = preferences(design, generator)
    return {OWN_SHARE: of_mean(clustered_mean(study.wins, study.participants, study.items))}


def conclude_equivalence(
    design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    """Return whether conditions are found equivalent, with a margin that `EFFECT` just reaches."""
    study = preferences(design, generator)
    share = clustered_mean(study.wins, study.participants, study.items)
    margin = true_win_share(replace(design, effect=EFFECT)) - 0.5
    return {EQUIVALENT: Conclusion(p_value=equivalence(share, margin, null=0.5).p_value)}


def conclude_heterogeneity(
    design: Design, generator: np.random.Generator
) -> Mapping[str, Conclusion]:
    """Return whether emotions and segments are found to differ in their preferences.

    With an effect, every second one of `EMOTIONS` is preferred by that much more. Segments differ
    whenever items do, so only the other studies measure false positives.
    """
    emotion = np.arange(design.items) % EMOTIONS
    shifts = np.where(emotion % 2, design.effect, -design.effect)
    study = preferences(replace(design, effect=0.0), generator, shifts=shifts)
    groups = emotion[study.items]
    found = between_groups(study.wins, groups, study.participants, study.items)
    numbers = {BY_EMOTION: Conclusion(p_value=found.p_value)}
    if not design.item_sd:
        apart = between_segments(study.wins, study.participants, study.items)
        numbers[BY_SEGMENT] = Conclusion(p_value=apart.p_value)
    return numbers


def _likelihood_ratio_p(full: OrdinalFit, reduced: OrdinalFit) -> float:
    converged = full.converged and reduced.converged
    return likelihood_ratio(full, reduced)[2] if converged else math.nan


def _true_shares(design: Design) -> Mapping[str, float]:
    share = true_win_share(design)
    return {WIN_SHARE: share, OWN_SHARE: share, LEFT_SHARE: 0.5}


def _true_effect(design: Design) -> Mapping[str, float]:
    return {WALD: design.effect}


PREFERENCES: Final = Protocol(
    conclude=conclude_preferences,
    truths=_true_shares,
    naive=("pooled binomial", "pooled Wilcoxon"),
)
NET_PREFERENCE: Final = Protocol(conclude=conclude_net_preference, truths=_true_effect)
MISMATCH: Final = Protocol(conclude=conclude_mismatch, truths=_true_shares)
EQUIVALENCE: Final = Protocol(
    conclude=conclude_equivalence, truths=no_truths, effects=(EFFECT, 0.0)
)
HETEROGENEITY: Final = Protocol(conclude=conclude_heterogeneity, truths=no_truths)
