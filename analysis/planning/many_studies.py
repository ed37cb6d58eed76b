"""Many simulated studies of one design at once: their answers, and tests of their means.

The latent difference of two conditions is the sum of an effect, a participant's and an item's
deviation, and logistic noise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from numpy.typing import NDArray
from scipy import stats
from scipy.special import expit, logit

from analysis.planning.part import RATING_THRESHOLDS, THRESHOLDS, Opinions, Part, Trials
from analysis.stats.clustered_mean import Clusters, clustered_variance

Floats = NDArray[np.float64]

POINTS: Final = len(RATING_THRESHOLDS) + 1
"""Points of the scale that `RATING_THRESHOLDS` cut."""

_NODES, _WEIGHTS = hermegauss(61)


def grade_preferences(latent: Floats, thresholds: Sequence[float] = THRESHOLDS) -> Floats:
    """Return the graded answer to a latent difference: below 0 for the second condition."""
    return np.asarray(np.sign(latent) * np.searchsorted(thresholds, np.abs(latent)), np.float64)


def simulate_answers(
    part: Part, opinions: Opinions, effect: float, studies: int, generator: np.random.Generator
) -> Floats:
    """Return what the participants of many studies answer in one block of a part.

    Parameters
    ----------
    effect : float
        By how much condition 0 is better than every other one, in logits.

    Returns
    -------
    ndarray, shape (studies, N) or (studies, N, conditions)
        Of pairs, from -2 or -1 (the second condition, in number) to 2 or 1 (the first); of
        ratings, scores from 1; of rankings, ranks, 1 for the best.
    """
    trials = part.trials
    if part.kind == "pairs":
        latent = _differences(trials, opinions, effect, studies, generator)
        latent += generator.logistic(size=latent.shape)
        return grade_preferences(latent, preference_thresholds(part.levels, opinions))
    worth = _worths(trials, opinions, effect, studies, generator)
    if part.kind == "rankings":
        worth += generator.gumbel(size=worth.shape)
        return np.asarray((-worth).argsort(axis=2).argsort(axis=2) + 1, np.float64)
    people = opinions.participant_sd * _each(trials.participants, studies, (), generator)
    items = opinions.item_sd * _each(trials.items, studies, (), generator)
    worth += (people + items)[..., None] + generator.logistic(size=worth.shape)
    return _rated(worth, part.levels)


def _worths(
    trials: Trials, opinions: Opinions, effect: float, studies: int, generator: np.random.Generator
) -> Floats:
    """Return how good each condition is in each trial, (studies, N, conditions), without noise."""
    worth = np.zeros((studies, len(trials.items), trials.conditions))
    worth[..., 0] = effect
    # A difference of two conditions varies twice as much as one of them.
    for sd, codes in (
        (opinions.participant_sd, trials.participants),
        (opinions.item_sd, trials.items),
    ):
        worth += sd / math.sqrt(2) * _each(codes, studies, (trials.conditions,), generator)
    return worth


def _each(
    codes: NDArray[np.intp], studies: int, beside: tuple[int, ...], generator: np.random.Generator
) -> Floats:
    """Return a normal draw for each group, repeated for its trials."""
    drawn = generator.standard_normal((studies, int(codes.max(initial=-1)) + 1, *beside))
    return np.asarray(drawn[:, codes], np.float64)


def _differences(
    trials: Trials, opinions: Opinions, effect: float, studies: int, generator: np.random.Generator
) -> Floats:
    """Return how much better the condition with the lower number is, shape (studies, N)."""
    if trials.conditions == 2:
        return (
            effect
            + opinions.participant_sd * _each(trials.participants, studies, (), generator)
            + opinions.item_sd * _each(trials.items, studies, (), generator)
        )
    if trials.left is None or trials.right is None:
        raise ValueError("trials of pairs say which conditions they show")
    worth = _worths(trials, opinions, effect, studies, generator)
    rows = np.arange(len(trials.items))
    first, second = np.minimum(trials.left, trials.right), np.maximum(trials.left, trials.right)
    return np.asarray(worth[:, rows, first] - worth[:, rows, second], np.float64)


def preference_thresholds(levels: int, opinions: Opinions) -> tuple[float, ...]:
    """Return the thresholds of a graded preference on the latent scale, in logits."""
    return {2: (0.0,), 3: (opinions.slight,), 5: (opinions.slight, opinions.clear)}[levels]


def rating_thresholds(levels: int) -> tuple[float, ...]:
    """Return the borders between the places of a rating scale, in logits.

    Those of a slider lie so that its ends are as far as those of a scale of five labels.
    """
    if levels == POINTS:
        return RATING_THRESHOLDS
    stretch = RATING_THRESHOLDS[-1] / math.log(POINTS - 1)
    return tuple((stretch * logit((np.arange(1, levels) - 0.5) / (levels - 1))).tolist())


def _rated(latent: Floats, levels: int) -> Floats:
    return np.asarray(1 + np.searchsorted(rating_thresholds(levels), latent), np.float64)


def describe_effect(part: Part, opinions: Opinions, effect: float) -> str:
    """Return what people answer where one condition is better by `effect` logits, in words."""
    spread = math.hypot(opinions.participant_sd, opinions.item_sd)
    if part.kind == "pairs":
        tie = preference_thresholds(part.levels, opinions)[0]
        wins = _mean(expit(effect + spread * _NODES - tie))
        losses = _mean(expit(-effect - spread * _NODES - tie))
        return f"{wins:.0%} wins, {losses:.0%} losses"
    if part.kind == "rankings":
        ahead = _mean(expit(effect + spread * _NODES))
        return f"ahead of another in {ahead:.0%} of rankings"
    # A level of the participant and item, and half of what a difference of two varies by.
    wide = spread * math.sqrt(1.5)
    borders = np.array(rating_thresholds(part.levels))[:, None]

    def rated(worth: float) -> float:
        return _mean(expit(worth + wide * _NODES - borders).sum(axis=0))

    return f"rated {rated(effect) - rated(0.0):.2g} higher on {part.levels} points"


def _mean(values: Floats) -> float:
    return float(_WEIGHTS @ values / _WEIGHTS.sum())


Codes = NDArray[np.intp]


def clustered_tests(values: Floats, participants: Codes, items: Codes) -> tuple[Floats, Floats]:
    """Test whether the means of many studies of one design are zero.

    The same as `analysis.stats.clustered_mean.clustered_mean` of each row.

    Parameters
    ----------
    values : ndarray, shape (studies, N)
        Answers, 0 for no preference.
    participants, items : ndarray of int, shape (N,)
        Who answered about what.

    Returns
    -------
    tuple of ndarray, shape (studies,)
        The means, and the two-sided p values; NaN where a study has no test.
    """
    studies, count = values.shape
    clusters = Clusters.of(participants, items)
    if not count or not clusters.participants.any():
        means = values.mean(axis=1) if count else np.full(studies, np.nan)
        return means, np.full(studies, np.nan)
    means = values.mean(axis=1)
    influences = (values - means[:, None]).T / count
    variance = clustered_variance(influences, clusters.participants, clusters.segments)
    with np.errstate(invalid="ignore", divide="ignore"):
        t = np.abs(means) / np.sqrt(variance.variance)
    p_values = 2 * stats.t(variance.df).sf(t)
    p_values[np.ptp(values, axis=1) == 0] = np.nan
    return means, np.asarray(p_values, np.float64)
