"""Whether the intervals keep their promise: simulated answers with a known truth.

``python -m analysis.validity`` prints, for designs of the sizes that studies have, how often the
interval of a win share contains the truth and how often a test at .05 finds a difference that is
not there, beside the pooled binomial test that papers use.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from numpy.typing import NDArray
from scipy import stats
from scipy.special import expit

from analysis.preferences.clustered import clustered_mean

_THRESHOLDS: Final = (0.45, 1.6)
"""Latent size of a difference from which answers are slight, and from which they are clear."""


@dataclass(frozen=True, kw_only=True)
class Design:
    """One comparison in which every participant answers about every segment.

    Attributes
    ----------
    participants, segments : int
        How many of each.
    effect : float
        Net preference for the reference in logits; 0 for none.
    participant_sd, segment_sd : float
        How much that preference varies between participants and between segments, in logits.
    """

    participants: int
    segments: int
    effect: float
    participant_sd: float
    segment_sd: float


@dataclass(frozen=True, kw_only=True)
class Validity:
    """What was measured over many simulated studies of one design.

    Attributes
    ----------
    coverage : float
        Share of intervals that contain the true win share.
    rejections : float
        Share of clustered tests with p < .05; the false-positive rate where the effect is 0.
    pooled_rejections : float
        The same for the binomial test over pooled answers, ties dropped.
    studies : int
        Simulated studies.
    """

    coverage: float
    rejections: float
    pooled_rejections: float
    studies: int


def simulate(
    design: Design, generator: np.random.Generator
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return answers (-2 … 2, towards the reference), participants and segments of one study."""
    people = np.repeat(np.arange(design.participants), design.segments)
    items = np.tile(np.arange(design.segments), design.participants)
    latent = (
        design.effect
        + design.participant_sd * generator.standard_normal(design.participants)[people]
        + design.segment_sd * generator.standard_normal(design.segments)[items]
        + generator.logistic(size=people.size)
    )
    answers = np.sign(latent) * np.searchsorted(_THRESHOLDS, np.abs(latent))
    return answers.astype(np.int64), people, items


def true_win_share(design: Design) -> float:
    """Return the win share over all participants and segments that `design` draws from."""
    nodes, weights = hermegauss(61)
    spread = np.hypot(design.participant_sd, design.segment_sd)
    latent = design.effect + spread * nodes
    wins = expit(latent - _THRESHOLDS[0])
    losses = expit(-latent - _THRESHOLDS[0])
    return float(weights @ ((1 + wins - losses) / 2) / weights.sum())


def measure(design: Design, *, studies: int, seed: int) -> Validity:
    """Simulate `studies` studies of `design` and count how often their conclusions are right."""
    generator = np.random.default_rng(seed)
    truth = true_win_share(design)
    covered = rejected = pooled = 0
    for _ in range(studies):
        answers, people, items = simulate(design, generator)
        found = clustered_mean((np.sign(answers) + 1) / 2, people, items)
        covered += found.low <= truth <= found.high
        rejected += found.p_value < 0.05
        wins, losses = int((answers > 0).sum()), int((answers < 0).sum())
        pooled += stats.binomtest(wins, wins + losses).pvalue < 0.05
    return Validity(
        coverage=covered / studies,
        rejections=rejected / studies,
        pooled_rejections=pooled / studies,
        studies=studies,
    )


_CLUSTERED: Final = Design(
    participants=22, segments=24, effect=0.0, participant_sd=0.6, segment_sd=0.45
)
DESIGNS: Final = tuple(
    replace(_CLUSTERED, **change)
    for change in (
        {},
        {"participant_sd": 0.0, "segment_sd": 0.0},
        {"participant_sd": 1.0, "segment_sd": 0.8},
        {"effect": 0.6},
        {"segments": 8, "participants": 25},
        {"segments": 6, "participants": 25},
        {"segments": 6, "participants": 25, "effect": 0.6},
        {"segments": 3, "participants": 25},
    )
)
"""AMUSE's size with and without clustering, and the small studies that one recording allows."""


def main(studies: int) -> None:
    """Print a table of `DESIGNS`."""
    print("people segments effect  sd(people) sd(segments) | interval holds  test  pooled binomial")
    for design in DESIGNS:
        found = measure(design, studies=studies, seed=1)
        print(
            f"{design.participants:6d} {design.segments:8d} {design.effect:6.1f} "
            f"{design.participant_sd:11.2f} {design.segment_sd:12.2f} | "
            f"{found.coverage:14.3f} {found.rejections:5.3f} {found.pooled_rejections:16.3f}"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 2000)
