"""What a rehearsal's raters really prefer, computed rather than counted."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from scipy.special import expit

from studyapp.definition.protocols.pairwise import PairwiseStudy, comparison_name
from studyapp.rehearsal.population import Population
from studyapp.rehearsal.raters import segment_fit
from studyapp.rehearsal.record import ExpectedShare

NODES, WEIGHTS = hermegauss(61)


def expected_shares(
    study: PairwiseStudy, segments: Sequence[str], *, population: Population, seed: int
) -> tuple[ExpectedShare, ...]:
    """Return what a rehearsal of `study` with the named `segments` should find."""
    expected = []
    for other in study.others:
        for question in study.questions:
            name = question.name
            gap = population.quality[study.reference][name] - population.quality[other][name]
            luck = np.array(
                [
                    segment_fit(population, seed, study.reference, segment, name)
                    - segment_fit(population, seed, other, segment, name)
                    for segment in segments
                ]
            )
            people = population.participant_sd
            expected.append(
                ExpectedShare(
                    comparison=comparison_name(study.reference, other),
                    question=name,
                    share=win_share(population, gap, math.hypot(people, population.item_sd)),
                    share_on_these_segments=float(
                        np.mean([win_share(population, gap + each, people) for each in luck])
                    ),
                )
            )
    return tuple(expected)


def win_share(population: Population, gap: float, slope_sd: float) -> float:
    """Return the expected wins plus half the ties of the better side of a pair.

    Each side is taken to be the left one half the time. An answer rests on
    ``s * (gap + slope) + bias + noise`` with ``s = 1`` where the first condition is on the right;
    as slope and bias are normal and independent, their sum is one normal, integrated over by
    Gauss-Hermite quadrature.

    Parameters
    ----------
    population : Population
        Gives thresholds and side bias.
    gap : float
        Mean difference in quality, first condition minus second, in logits.
    slope_sd : float
        Standard deviation of that difference over what the share averages over, in logits.

    Returns
    -------
    float
        Share of the first condition in [0, 1]; .5 where `gap` is 0.
    """
    spread = math.hypot(slope_sd, population.side_bias_sd) * NODES
    total = 0.0
    for side in (1.0, -1.0):
        latent = side * gap + population.side_bias + spread
        right = expit(latent - population.weak)
        tie = expit(population.weak - latent) - expit(-population.weak - latent)
        share_of_right = float(WEIGHTS @ (right + tie / 2) / WEIGHTS.sum())
        total += share_of_right if side > 0 else 1 - share_of_right
    return total / 2
