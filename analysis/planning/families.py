"""What corrected tests decide: blocks of p values in the company that their report gives them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.stats.holm import holm_rows

Floats = NDArray[np.float64]

LEVEL: Final = 0.05
"""Corrected p values below it decide."""

ROUNDS: Final = 8
"""Companies that each block is corrected in."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Findings:
    """What tests say, study by study.

    Attributes
    ----------
    p_values : ndarray, shape (studies, tests)
        NaN where a test cannot be made.
    signs : ndarray, shape (studies, tests)
        Above 0 where the first of the two conditions comes out better.
    """

    p_values: Floats
    signs: Floats


@dataclass(frozen=True, kw_only=True, eq=False)
class Company:
    """The other blocks of tests that a report corrects together with one.

    Attributes
    ----------
    pools : tuple of ndarray, shape (studies, tests)
        Of each part of the family, p values of simulated blocks.
    counts : tuple of int
        How many blocks of each part stand beside the one.
    """

    pools: tuple[Floats, ...]
    counts: tuple[int, ...]

    def drawn(self, blocks: int, generator: np.random.Generator) -> Floats:
        """Return the p values of `blocks` random companies, shape (blocks, tests)."""
        found = [
            pool[generator.integers(len(pool), size=(blocks, count))].reshape(blocks, -1)
            for pool, count in zip(self.pools, self.counts, strict=True)
            if count
        ]
        return np.concatenate(found, axis=1) if found else np.empty((blocks, 0))


def decided_by_holm(p_values: Floats, company: Company, seed: int) -> Floats:
    """Return how probable it is that each test of each block decides, shape (blocks, tests).

    Parameters
    ----------
    p_values : ndarray, shape (blocks, tests)
        Of one block each.
    company : Company
        What they are corrected together with.
    seed : int
        Draws the companies; the same for what is to be compared.
    """
    generator = np.random.default_rng(seed)
    rounds = ROUNDS if any(company.counts) else 1
    own = p_values.shape[1]
    decided = np.zeros(p_values.shape)
    for _ in range(rounds):
        whole = np.concatenate([p_values, company.drawn(len(p_values), generator)], axis=1)
        decided += holm_rows(whole)[:, :own] < LEVEL
    return decided / rounds


def right(tested: Findings, decided: Floats, true: Sequence[bool], *, effect: float) -> Floats:
    """Return the share of a block's true differences that are found, shape (blocks,).

    A difference counts as found where the better condition comes out ahead. Without an effect
    there is none, and every test that decides counts.

    Parameters
    ----------
    true : sequence of bool
        Which tests compare conditions that differ where there is an effect.
    """
    if not effect:
        return np.asarray(decided.mean(axis=1), np.float64)
    found = np.where(tested.signs > 0, decided, 0.0)[:, np.array(true, bool)]
    return np.asarray(found.mean(axis=1), np.float64)
