"""The information matrix of crossed random effects, factorised without ever being written down.

Each random effect of one term belongs to one group, so that a term's block is diagonal. The
largest term is eliminated; what remains (its Schur complement) is as wide as the other terms
together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


@dataclass(frozen=True)
class Layout:
    """Which group of which term each answer belongs to; the largest term stands first.

    Attributes
    ----------
    groups : tuple of ndarray of int, shape (N,)
        For each term, the group of every answer, from 0.
    sizes : tuple of int
        For each term, its number of groups.
    """

    groups: tuple[Codes, ...]
    sizes: tuple[int, ...]

    @cached_property
    def offsets(self) -> tuple[int, ...]:
        """Where the effects of each later term begin in the remaining block."""
        return tuple(int(sum(self.sizes[1:term])) for term in range(1, len(self.sizes)))

    @property
    def width(self) -> int:
        """Size of the remaining block."""
        return int(sum(self.sizes[1:]))

    @property
    def count(self) -> int:
        """Number of random effects of all terms together."""
        return int(sum(self.sizes))

    def part(self, chosen: Codes) -> Layout:
        """Return the layout of the answers `chosen`; every group stays."""
        return Layout(tuple(codes[chosen] for codes in self.groups), self.sizes)

    def spread(self, effects: Floats) -> list[Floats]:
        """Return each answer's effect of each term."""
        found, start = [], 0
        for codes, size in zip(self.groups, self.sizes, strict=True):
            found.append(effects[start : start + size][codes])
            start += size
        return found

    def gather(self, per_answer: Sequence[Floats]) -> Floats:
        """Return the sums over each group of each term; the transpose of `spread`."""
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
        Which answers belong together.
    first : ndarray, shape (size of the first term,)
        The first term's diagonal block.
    across : ndarray, shape (size of the first term, width)
        Between the first and the other terms.
    factor : tuple
        Cholesky factor of the Schur complement, as scipy's `cho_factor` gives it.
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
            For each term, what an answer's random effect is multiplied with.
        weights : ndarray, shape (N,)
            Minus the second derivative of each answer's log-likelihood.
        """
        size, width = layout.sizes[0], layout.width
        head = multipliers[0]
        own = np.bincount(layout.groups[0], weights=weights * head**2, minlength=size)
        first = 1.0 + np.asarray(own, np.float64)
        across = np.zeros((size, width))
        rest = np.eye(width)
        for number, start in enumerate(layout.offsets, start=1):
            stop = start + layout.sizes[number]
            codes, scaled = layout.groups[number], weights * multipliers[number]
            across[:, start:stop] = _sums(
                layout.groups[0], codes, scaled * head, (size, stop - start)
            )
            for other, begin in enumerate(layout.offsets[:number], start=1):
                end = begin + layout.sizes[other]
                block = _sums(
                    codes,
                    layout.groups[other],
                    scaled * multipliers[other],
                    (stop - start, end - begin),
                )
                rest[start:stop, begin:end] += block
                if other != number:
                    rest[begin:end, start:stop] += block.T
        rest -= across.T @ (across / first[:, None])
        return cls(layout, first, across, cho_factor(rest, lower=True))

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
        rest = cho_solve(self.factor, tail - self.across.T @ (head / first))
        return np.concatenate([(head - self.across @ rest) / first, rest])

    def directions(self, multipliers: Sequence[Floats]) -> list[Floats]:
        """Return, for each term, the entry of C m that belongs to each answer's group.

        C is the inverse and m an answer's row of the design, so that the sum over the terms of
        multiplier times entry is that answer's variance m' C m.
        """
        inverse = cho_solve(self.factor, np.eye(self.layout.width))
        scaled = self.across / self.first[:, None]
        between = -scaled @ inverse
        own = 1 / self.first - np.einsum("ij,ij->i", scaled, between)
        first = self.layout.groups[0]
        later = [
            (start + codes, multiplier)
            for start, codes, multiplier in zip(
                self.layout.offsets, self.layout.groups[1:], multipliers[1:], strict=True
            )
        ]
        found = [multipliers[0] * own[first]]
        for column, multiplier in later:
            found[0] += multiplier * between[first, column]
        for row, _ in later:
            direction = multipliers[0] * between[first, row]
            for column, multiplier in later:
                direction += multiplier * inverse[row, column]
            found.append(direction)
        return found


def _sums(rows: Codes, columns: Codes, values: Floats, shape: tuple[int, int]) -> Floats:
    """Return the matrix of sums of `values` by row and column."""
    cells = rows * shape[1] + columns
    sums = np.bincount(cells, weights=values, minlength=shape[0] * shape[1])
    return np.asarray(sums, np.float64).reshape(shape)
