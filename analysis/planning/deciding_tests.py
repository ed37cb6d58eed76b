"""The tests by which a report decides, for many studies at once.

Ratings, and preferences of few participants or segments, are tested as in the report. A mean of
graded preferences replaces the mixed model, and a fit to all studies at once that of each one.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from analysis.planning.part import Part, Trials
from analysis.results.preference import FEWEST
from analysis.stats.clustered_mean import Clusters, clustered_variance, t_p_value
from analysis.stats.multiple_testing import holm_rows
from motion.arrays import Floats, Indices

LEVEL: Final = 0.05
"""Corrected p values below this are significant."""

ROUNDS: Final = 8
"""Number of random families in which each block is corrected."""

LIKE_A_MODEL: Final = 1.5
"""Factor of the degrees of freedom with which a mean of graded preferences finds as much as the
mixed model, whose likelihood ratio is compared with a chi-square."""

_STEPS: Final = 50
_CLOSE: Final = 1e-6


class BlockTests(NamedTuple):
    """The tests of one block of a part, study by study.

    Attributes
    ----------
    p_values : ndarray, shape (studies, tests)
        NaN if there is no test.
    signs : ndarray, shape (studies, tests)
        Above 0 if the first of the two conditions comes out better.
    """

    p_values: Floats
    signs: Floats


def block_tests(part: Part, answers: Floats) -> BlockTests:
    """Test each pair of conditions in all studies in `answers`, as `simulate_answers` gives."""
    trials = part.trials
    if part.kind == "rankings":
        return worth_tests(answers, trials)
    tests = []
    for a, b in trials.pairs:
        rows, freedom = trials.of_pair(a, b), 1.0
        participants, items = trials.participants[rows], trials.items[rows]
        if part.kind == "ratings":
            values = answers[..., a] - answers[..., b]
        else:
            values = answers[:, rows]
            if min(len(np.unique(codes)) for codes in (participants, items)) < FEWEST:
                values = np.sign(values) / 2
            else:
                freedom = LIKE_A_MODEL
        tests.append(clustered_tests(values, participants, items, freedom))
    means, p_values = (np.column_stack(column) for column in zip(*tests, strict=True))
    return BlockTests(p_values=p_values, signs=np.sign(means))


def clustered_tests(
    values: Floats, participants: Indices, items: Indices, freedom: float = 1.0
) -> tuple[Floats, Floats]:
    """Test whether the means of many studies of one design are zero.

    The same as `analysis.stats.clustered_mean.clustered_mean` of each row.

    Parameters
    ----------
    values : ndarray, shape (studies, N)
        Answers, 0 for no preference.
    participants, items : ndarray of int, shape (N,)
        The participant and the item of each answer.
    freedom : float
        Factor of the degrees of freedom.

    Returns
    -------
    tuple of ndarray, shape (studies,)
        The means, and the two-sided p values; NaN if a study has no test.
    """
    if not values.shape[1]:
        missing = np.full(len(values), np.nan)
        return missing, missing
    means = values.mean(axis=1)
    influences = (values - means[:, None]).T / values.shape[1]
    p_values = _p_values(means, influences, Clusters.of(participants, items), freedom)
    p_values[np.ptp(values, axis=1) == 0] = np.nan
    return means, p_values


def worth_tests(rankings: Floats, trials: Trials) -> BlockTests:
    """Test the differences of Plackett and Luce's worths in many studies of complete rankings.

    The same as `analysis.stats.strength_models.plackett_luce` of each study, but that the prior for
    conditions that never lost is always used, and that all rankings have equal weight.

    Parameters
    ----------
    rankings : ndarray, shape (studies, N, conditions)
        Ranks from 1, without ties.
    trials : Trials
        The participant and the item of each ranking.
    """
    places = rankings.astype(np.intp) - 1
    order = places.argsort(axis=2)
    worths = np.zeros((len(places), trials.conditions))
    own = np.arange(trials.conditions)
    # The place down to which two conditions both remain to be chosen.
    shared = np.minimum(places[..., None], places[..., None, :])
    for _ in range(_STEPS):
        weights, chance = np.exp(worths), 1 / (1 + np.exp(-worths))
        of_places = np.take_along_axis(np.broadcast_to(weights[:, None], places.shape), order, 2)
        remaining = of_places[..., ::-1].cumsum(axis=2)[..., ::-1]
        chosen = np.take_along_axis((1 / remaining).cumsum(axis=2), places, 2) * weights[:, None]
        both = np.take_along_axis((remaining**-2).cumsum(axis=2)[..., None, :], shared, 3)
        information = -weights[:, :, None] * weights[:, None] * both.sum(axis=1)
        information[:, own, own] += chosen.sum(axis=1) + chance * (1 - chance)
        score = (1 - chosen).sum(axis=1) + 0.5 - chance
        step = np.linalg.solve(information, score[..., None])[..., 0]
        worths += np.clip(step, -1, 1)
        if np.abs(step).max(initial=0.0) < _CLOSE:
            break
    influences = np.linalg.solve(information, (1 - chosen).swapaxes(1, 2))
    clusters = Clusters.of(trials.participants, trials.items)
    first, second = np.array(trials.pairs).T
    differences = worths[:, first] - worths[:, second]
    p_values = [
        _p_values(difference, (influences[:, a] - influences[:, b]).T, clusters)
        for difference, a, b in zip(differences.T, first, second, strict=True)
    ]
    return BlockTests(p_values=np.column_stack(p_values), signs=np.sign(differences))


def _p_values(
    estimates: Floats, influences: Floats, clusters: Clusters, freedom: float = 1.0
) -> Floats:
    """Return the p values of many estimates, shape (studies,), by influences (N, studies)."""
    variance = clustered_variance(influences, clusters.participants, clusters.segments)
    with np.errstate(invalid="ignore", divide="ignore"):
        return t_p_value(estimates / np.sqrt(variance.variance), freedom * variance.df)


def decided_by_holm(
    p_values: Floats, other_blocks: Sequence[tuple[Floats, int]], seed: int
) -> Floats:
    """Return the probability that each test of each block is significant, (blocks, tests).

    Parameters
    ----------
    p_values : ndarray, shape (blocks, tests)
        The tests' p-values, a row for each block.
    other_blocks : sequence of (ndarray, shape (studies, tests), int)
        The family's other blocks, corrected together with each block: for each part, p values of
        simulated blocks, and how many of them to draw.
    seed : int
        Seed for drawing the other blocks.
    """
    generator = np.random.default_rng(seed)
    blocks, tests = p_values.shape
    rounds = ROUNDS if any(count for _, count in other_blocks) else 1
    decided = np.zeros(p_values.shape)
    for _ in range(rounds):
        drawn = [
            pool[generator.integers(len(pool), size=(blocks, count))].reshape(blocks, -1)
            for pool, count in other_blocks
            if count
        ]
        decided += holm_rows(np.concatenate([p_values, *drawn], axis=1))[:, :tests] < LEVEL
    return decided / rounds


def detection_shares(
    signs: Floats, decided: Floats, true: Sequence[bool], *, effect: float
) -> Floats:
    """Return the share of a block's true differences that are found, shape (blocks,).

    A difference is found if its test is significant and the better condition comes out ahead.
    Without an effect there is none, and every significant test counts.

    Parameters
    ----------
    signs, decided : ndarray, shape (blocks, tests)
        Which condition comes out better, and the probability that the test is significant.
    true : sequence of bool
        Which tests compare conditions that differ if there is an effect.
    """
    if not effect:
        return np.asarray(decided.mean(axis=1), np.float64)
    detected = np.where(signs > 0, decided, 0.0)[:, np.array(true, bool)]
    return np.asarray(detected.mean(axis=1), np.float64)
