"""Kernel distance of embeddings (KID): unbiased at any sample size, so it may be below 0.

The squared maximum mean discrepancy with the kernel ``k(x, y) = (x·y / d + 1)³`` (Bińkowski et al.
2018, "Demystifying MMD GANs"). It stands beside every Fréchet distance of few samples.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.result import MetricResult
from analysis.metrics.samples import Embeddings, check_dimensions

FloatArray = NDArray[np.float64]

_BLOCK: Final = 1000
"""Rows of the kernel matrix held at a time: bounds the memory."""

_FEWEST_CLIPS: Final = 5


def kernel_distance(
    generated: Embeddings,
    reference: Embeddings,
    *,
    name: str = "kernel distance (KID)",
    settings: Mapping[str, str] | None = None,
) -> MetricResult:
    """Return the unbiased kernel distance between generated and recorded motion.

    Parameters
    ----------
    generated, reference : Embeddings
        Of the same feature network; the sizes may differ.
    name : str
        What the embeddings are of.
    settings : mapping, optional
        The feature network and its hash, representation, frame rate, window and stride.

    Returns
    -------
    MetricResult
        0 on average for equal distributions, so single scores may be negative and are not cut
        off. The interval is ± 1.96 standard errors of a jackknife that leaves out one clip after
        the other. NaN for fewer than two samples on either side.
    """
    check_dimensions(generated, reference)
    described = dict(settings or {}) | {
        "samples": f"{len(generated)} generated, {len(reference)} recorded",
        "dimensions": f"{generated.values.shape[1]}",
        "kernel": "(x·y / d + 1)³, unbiased",
    }
    if min(len(generated), len(reference)) < 2:
        return MetricResult(
            name=name,
            value=math.nan,
            unit="",
            n=min(len(generated), len(reference)),
            settings=described,
            reason="an unbiased kernel distance needs two samples on either side",
            better="lower",
        )
    sums = _Sums.of(generated, reference)
    value = sums.distance
    interval = None
    error = sums.standard_error()
    if error is not None:
        described["interval"] = "± 1.96 standard errors, jackknife over clips"
        interval = (value - 1.96 * error, value + 1.96 * error)
    return MetricResult(
        name=name,
        value=value,
        unit="",
        n=len(generated) + len(reference),
        settings=described,
        interval=interval,
        better="lower",
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Within:
    """Kernel sums within one sample, by clip.

    Attributes
    ----------
    rows : ndarray, shape (C,)
        Rows of each clip.
    touching : ndarray, shape (C,)
        Sum over pairs of different rows that contain a row of the clip, on either side.
    total : float
        Sum over all ordered pairs of different rows.
    """

    rows: FloatArray
    touching: FloatArray
    total: float

    @property
    def mean(self) -> float:
        count = self.rows.sum()
        return float(self.total / (count * (count - 1)))

    def means_without(self) -> FloatArray:
        """Return the mean over pairs that are left when each clip in turn is left out."""
        left = self.rows.sum() - self.rows
        return np.asarray((self.total - self.touching) / (left * (left - 1)))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sums:
    """All that the distance, and the distance without any one clip, are made of."""

    generated: _Within
    reference: _Within
    across_generated: FloatArray
    across_reference: FloatArray

    @classmethod
    def of(cls, generated: Embeddings, reference: Embeddings) -> _Sums:
        by_row = np.zeros(len(generated))
        by_column = np.zeros(len(reference))
        for start in range(0, len(generated), _BLOCK):
            kernel = _kernel(generated.values[start : start + _BLOCK], reference.values)
            by_row[start : start + _BLOCK] = kernel.sum(axis=1)
            by_column += kernel.sum(axis=0)
        return cls(
            generated=_within(generated),
            reference=_within(reference),
            across_generated=np.asarray(np.bincount(generated.clips, by_row), float),
            across_reference=np.asarray(np.bincount(reference.clips, by_column), float),
        )

    @property
    def distance(self) -> float:
        pairs = self.generated.rows.sum() * self.reference.rows.sum()
        across = self.across_generated.sum() / pairs
        return float(self.generated.mean + self.reference.mean - 2 * across)

    def standard_error(self) -> float | None:
        """Return the jackknife's standard error; None for too few clips."""
        sides = (
            (self.generated, self.reference, self.across_generated),
            (self.reference, self.generated, self.across_reference),
        )
        variance = 0.0
        for own, other, across in sides:
            clips = len(own.rows)
            left = own.rows.sum() - own.rows
            if clips < _FEWEST_CLIPS or (left < 2).any():
                return None
            between = (across.sum() - across) / (left * other.rows.sum())
            without = own.means_without() + other.mean - 2 * between
            variance += (clips - 1) / clips * np.sum((without - without.mean()) ** 2)
        return math.sqrt(variance)


def _within(sample: Embeddings) -> _Within:
    sums = np.zeros(len(sample))
    for start in range(0, len(sample), _BLOCK):
        rows = sample.values[start : start + _BLOCK]
        sums[start : start + _BLOCK] = _kernel(rows, sample.values).sum(axis=1)
    sums -= (np.einsum("nd,nd->n", sample.values, sample.values) / sample.values.shape[1] + 1) ** 3
    rows_of = np.bincount(sample.clips).astype(float)
    inside = np.zeros(len(rows_of))
    for clip in np.flatnonzero(rows_of > 1):
        own = sample.values[sample.clips == clip]
        kernel = _kernel(own, own)
        inside[clip] = kernel.sum() - np.trace(kernel)
    return _Within(
        rows=rows_of,
        touching=2 * np.bincount(sample.clips, sums) - inside,
        total=float(sums.sum()),
    )


def _kernel(one: FloatArray, other: FloatArray) -> FloatArray:
    return np.asarray((one @ other.T / one.shape[1] + 1) ** 3)
