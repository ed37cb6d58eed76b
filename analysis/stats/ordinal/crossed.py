"""The information matrix of crossed random effects, factorised without being written out.

Each random effect of a term belongs to one group, so a term's block is diagonal. The largest term
is eliminated; the remainder (its Schur complement) is as wide as the other terms together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.linalg.lapack import dpotri

from motion.arrays import Floats, Indices


@dataclass(frozen=True)
class Layout:
    """The group of each answer in each term, with the largest term first.

    Attributes
    ----------
    groups : tuple of ndarray of int, shape (N,)
        For each term, the group of every answer, from 0.
    sizes : tuple of int
        For each term, its number of groups.
    """

    groups: tuple[Indices, ...]
    sizes: tuple[int, ...]

    @cached_property
    def offsets(self) -> tuple[int, ...]:
        """Index of the first effect of each later term in the remaining block."""
        return tuple(int(sum(self.sizes[1:term])) for term in range(1, len(self.sizes)))

    @property
    def width(self) -> int:
        """Size of the remaining block."""
        return int(sum(self.sizes[1:]))

    @property
    def count(self) -> int:
        """Number of random effects of all terms together."""
        return int(sum(self.sizes))

    @cached_property
    def across_cells(self) -> tuple[Indices, ...]:
        """For each later term, each answer's index in the flattened `Information.across`."""
        return tuple(
            self.groups[0] * self.width + start + codes
            for start, codes in zip(self.offsets, self.groups[1:], strict=True)
        )

    @cached_property
    def rest_cells(self) -> dict[tuple[int, int], Indices]:
        """For each pair of later terms, each answer's index in the flattened remaining block."""
        codes = [
            start + term_codes
            for start, term_codes in zip(self.offsets, self.groups[1:], strict=True)
        ]
        return {
            (number, other): codes[number] * self.width + codes[other]
            for number in range(len(codes))
            for other in range(number)
        }

    def spread(self, effects: Floats) -> list[Floats]:
        """Return each answer's effect of each term."""
        per_answer, start = [], 0
        for codes, size in zip(self.groups, self.sizes, strict=True):
            per_answer.append(effects[start : start + size][codes])
            start += size
        return per_answer

    def gather(self, per_answer: Sequence[Floats]) -> Floats:
        """Return the sums over each group of each term: the transpose of `spread`."""
        return np.concatenate(
            [
                np.bincount(codes, weights=values, minlength=size)
                for codes, size, values in zip(self.groups, self.sizes, per_answer, strict=True)
            ]
        )


@dataclass(frozen=True)
class Information:
    """The matrix I + M' W M for answers with weights W and random-effect design M.

    Attributes
    ----------
    layout : Layout
        The groups of the answers.
    first : ndarray, shape (size of the first term,)
        The first term's diagonal block.
    across : ndarray, shape (size of the first term, width)
        The block between the first and the other terms.
    factor : tuple
        Cholesky factor of the Schur complement, from scipy's `cho_factor`.
    """

    layout: Layout
    first: Floats
    across: Floats
    factor: tuple[Floats, bool]

    @classmethod
    def of(cls, layout: Layout, multipliers: Sequence[Floats], weights: Floats) -> Information:
        """Factorise the matrix.

        Parameters
        ----------
        multipliers : sequence of ndarray, shape (N,)
            For each term, the multiplier of each answer's random effect.
        weights : ndarray, shape (N,)
            Minus the second derivative of each answer's log-likelihood.
        """
        size, width = layout.sizes[0], layout.width
        weighted = [weights * multiplier for multiplier in multipliers]
        blocks = layout.gather([w * m for w, m in zip(weighted, multipliers, strict=True)])
        first = 1.0 + blocks[:size]
        flat_across, flat_rest = np.zeros(size * width), np.zeros(width * width)
        for number, cells in enumerate(layout.across_cells, start=1):
            flat_across += _sums(cells, weighted[0] * multipliers[number], size * width)
        for (number, other), cells in layout.rest_cells.items():
            flat_rest += _sums(cells, weighted[number + 1] * multipliers[other + 1], width * width)
        across, half = flat_across.reshape(size, width), flat_rest.reshape(width, width)
        schur = half + half.T
        schur[np.diag_indices(width)] += 1.0 + blocks[size:]
        schur -= across.T @ (across / first[:, None])
        return cls(layout, first, across, cho_factor(schur, lower=True))

    @property
    def log_determinant(self) -> float:
        """Logarithm of the determinant."""
        diagonal = np.diagonal(self.factor[0])
        return float(np.log(self.first).sum() + 2 * np.log(diagonal).sum())

    def solve(self, right: Floats) -> Floats:
        """Return the matrix's inverse times `right`, shape (count,) or (count, k)."""
        size = self.layout.sizes[0]
        head, tail = right[:size], right[size:]
        first = self.first if right.ndim == 1 else self.first[:, None]
        tail_solution = cho_solve(self.factor, tail - self.across.T @ (head / first))
        return np.concatenate([(head - self.across @ tail_solution) / first, tail_solution])

    def directions(self, multipliers: Sequence[Floats]) -> list[Floats]:
        """Return, for each term, the entry of C m for each answer's group.

        C is the inverse and m an answer's row of the design, so the sum over terms of multiplier
        times entry is that answer's variance m' C m.
        """
        inverse = _inverse(self.factor)
        scaled = self.across / self.first[:, None]
        between = -scaled @ inverse
        variances = 1 / self.first - np.einsum("ij,ij->i", scaled, between)
        layout, head = self.layout, multipliers[0]
        entries = [head * variances[layout.groups[0]]]
        for number, cells in enumerate(layout.across_cells, start=1):
            covariances = between.ravel()[cells]
            entries[0] += multipliers[number] * covariances
            entries.append(head * covariances)
        diagonal = np.diagonal(inverse)
        for number, start in enumerate(layout.offsets, start=1):
            entries[number] += multipliers[number] * diagonal[start + layout.groups[number]]
        for (number, other), cells in layout.rest_cells.items():
            covariances = inverse.ravel()[cells]
            entries[number + 1] += multipliers[other + 1] * covariances
            entries[other + 1] += multipliers[number + 1] * covariances
        return entries


def _inverse(factor: tuple[Floats, bool]) -> Floats:
    """Return the inverse of a matrix from its lower Cholesky factor."""
    if not factor[0].size:
        return factor[0]
    lower, _ = dpotri(factor[0], lower=True)
    lower = np.tril(lower)
    return np.asarray(lower + np.tril(lower, -1).T, np.float64)


def _sums(cells: Indices, values: Floats, count: int) -> Floats:
    """Return the sums of `values` by cell."""
    return np.asarray(np.bincount(cells, weights=values, minlength=count), np.float64)
