"""The tests by which a report decides, and quick approximations for many studies at once.

Where the report tests a mean, the quick test is the same. Where it fits a model, the quick test
replaces it: the two nearly always agree, and their difference is measured on some studies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import pandas as pd

from analysis.planning.part import Part
from analysis.results.mixed_models import SidedAnswers, net_preference
from analysis.results.preference import FEWEST
from analysis.stats.clustered_mean import Clusters, clustered_variance, t_p_value
from analysis.stats.multiple_testing import holm_rows
from analysis.stats.strength_differences import difference_tests
from analysis.stats.strength_models import plackett_luce
from motion.arrays import Floats, Indices

LEVEL: Final = 0.05
"""Corrected p values below this are significant."""

ROUNDS: Final = 8
"""Number of random families in which each block is corrected."""


@dataclass(frozen=True, eq=False)
class DecidingTests:
    """The tests of one block of a part.

    Attributes
    ----------
    part : Part
        The part that is tested.
    """

    part: Part

    @cached_property
    def pairs(self) -> Sequence[tuple[int, int]]:
        """The two conditions of each test."""
        return self.part.trials.pairs

    @cached_property
    def by_model(self) -> tuple[bool, ...]:
        """Whether a model decides each test; else a clustered mean does."""
        if self.part.kind == "ratings":
            return (False,) * len(self.pairs)
        if self.part.kind == "rankings":
            return (True,) * len(self.pairs)
        return tuple(self._groups(rows) >= FEWEST for rows in self._rows)

    @cached_property
    def _rows(self) -> list[Indices]:
        return [self.part.trials.of_pair(a, b) for a, b in self.pairs]

    def _groups(self, rows: Indices) -> int:
        """Return the number of participants or of items in these trials, whichever is smaller."""
        trials = self.part.trials
        return min(len(np.unique(codes[rows])) for codes in (trials.participants, trials.items))

    def quick(self, answers: Floats) -> BlockTests:
        """Test all studies in `answers`, which come from `simulate_answers`."""
        tests = [
            self._clustered(answers, rows, pair, modelled)
            for rows, pair, modelled in zip(self._rows, self.pairs, self.by_model, strict=True)
        ]
        means, p_values = (np.column_stack(column) for column in zip(*tests, strict=True))
        return BlockTests(p_values=p_values, signs=np.sign(means))

    def exact(self, answers: Floats) -> BlockTests:
        """Test each study in `answers` by the models that decide in the report."""
        results = self.quick(answers)
        for study, study_answers in enumerate(answers):
            if self.part.kind == "rankings":
                results.p_values[study], results.signs[study] = self._worth_tests(study_answers)
                continue
            for test, (rows, modelled) in enumerate(zip(self._rows, self.by_model, strict=True)):
                if modelled:
                    net = net_preference(self._sided(study_answers, rows))
                    results.p_values[study, test] = net.p_value
                    results.signs[study, test] = np.sign(net.estimate)
        return results

    def _clustered(
        self, answers: Floats, rows: Indices, pair: tuple[int, int], modelled: bool
    ) -> tuple[Floats, Floats]:
        participants, items = self.part.trials.participants[rows], self.part.trials.items[rows]
        if self.part.kind == "pairs":
            # The report's win share; for a model, graded scores, which approximate it better.
            preferences = answers[:, rows]
            return clustered_tests(
                preferences if modelled else np.sign(preferences) / 2, participants, items
            )
        scores = _savage_scores(answers) if modelled else answers
        a, b = pair
        return clustered_tests(scores[..., a] - scores[..., b], participants, items)

    def _sided(self, preferences: Floats, rows: Indices) -> SidedAnswers:
        trials, signed = self.part.trials, preferences[rows].astype(np.int64)
        left, right = trials.sides
        on_right = (left > right)[rows]
        return SidedAnswers(
            responses=3 + np.where(on_right, signed, -signed),
            on_right=on_right,
            participants=trials.participants[rows],
            segments=trials.items[rows],
        )

    def _worth_tests(self, ranks: Floats) -> tuple[Floats, Floats]:
        """Return p values and signs of the differences of worths."""
        trials = self.part.trials
        count, width = ranks.shape
        names = [str(number) for number in range(width)]
        fit = plackett_luce(
            pd.DataFrame(
                {
                    "ranking": np.repeat(np.arange(count), width),
                    "participant": np.repeat(trials.participants, width),
                    "segment": np.repeat(trials.items, width),
                    "condition": np.tile(names, count),
                    "rank": ranks.ravel(),
                }
            ),
            names,
        )
        first, second = np.array(self.pairs).T
        signs = np.sign(fit.strengths[first] - fit.strengths[second])
        if fit.two_way is None:
            return np.full(len(self.pairs), np.nan), signs
        return difference_tests(fit.strengths, fit.two_way)[first, second], signs


def clustered_tests(values: Floats, participants: Indices, items: Indices) -> tuple[Floats, Floats]:
    """Test whether the means of many studies of one design are zero.

    The same as `analysis.stats.clustered_mean.clustered_mean` of each row.

    Parameters
    ----------
    values : ndarray, shape (studies, N)
        Answers, 0 for no preference.
    participants, items : ndarray of int, shape (N,)
        The participant and the item of each answer.

    Returns
    -------
    tuple of ndarray, shape (studies,)
        The means, and the two-sided p values; NaN if a study has no test.
    """
    if not values.shape[1]:
        missing = np.full(len(values), np.nan)
        return missing, missing
    clusters = Clusters.of(participants, items)
    means = values.mean(axis=1)
    influences = (values - means[:, None]).T / values.shape[1]
    variance = clustered_variance(influences, clusters.participants, clusters.segments)
    with np.errstate(invalid="ignore", divide="ignore"):
        t = np.abs(means) / np.sqrt(variance.variance)
    p_values = t_p_value(t, variance.df)
    p_values[np.ptp(values, axis=1) == 0] = np.nan
    return means, p_values


def _savage_scores(ranks: Floats) -> Floats:
    """Return Savage scores of ranks, the best highest, in place of a Plackett-Luce model."""
    steps = np.cumsum(1 / np.arange(ranks.shape[-1], 0, -1))
    return np.asarray(-steps[ranks.astype(np.intp) - 1], np.float64)


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockTests:
    """P values and signs of tests, study by study.

    Attributes
    ----------
    p_values : ndarray, shape (studies, tests)
        NaN if there is no test.
    signs : ndarray, shape (studies, tests)
        Above 0 if the first of the two conditions comes out better.
    """

    p_values: Floats
    signs: Floats

    @classmethod
    def joined(cls, results: Sequence[BlockTests]) -> BlockTests:
        """Return the results of all studies together."""
        return cls(
            p_values=np.concatenate([each.p_values for each in results]),
            signs=np.concatenate([each.signs for each in results]),
        )


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
        Seed for drawing the other blocks; use the same for results that are compared.
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
    results: BlockTests, decided: Floats, true: Sequence[bool], *, effect: float
) -> Floats:
    """Return the share of a block's true differences that are found, shape (blocks,).

    A difference is found if its test is significant and the better condition comes out ahead.
    Without an effect there is none, and every significant test counts.

    Parameters
    ----------
    true : sequence of bool
        Which tests compare conditions that differ if there is an effect.
    """
    if not effect:
        return np.asarray(decided.mean(axis=1), np.float64)
    detected = np.where(results.signs > 0, decided, 0.0)[:, np.array(true, bool)]
    return np.asarray(detected.mean(axis=1), np.float64)
