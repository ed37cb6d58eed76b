"""Kernel distance of embeddings (KID): unbiased at any sample size, so it may be below 0.

The squared maximum mean discrepancy with the kernel ``k(x, y) = (x·y / d + 1)³`` (Bińkowski et al.
2018, "Demystifying MMD GANs"). It accompanies every Fréchet distance.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from analysis.metrics.embeddings import FEWEST_CLIPS, Embeddings
from analysis.metrics.scores import Metric, MetricResult
from motion.arrays import Floats

_BLOCK: Final = 1000
"""Rows of the kernel matrix held at a time, which bounds the memory."""


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
        Embeddings by the same feature network; the sizes may differ.
    name : str
        The metric's name.
    settings : mapping, optional
        The feature network and its hash, representation, frame rate, window and stride.

    Returns
    -------
    MetricResult
        0 on average for equal distributions, so single scores may be negative. The interval is
        ± 1.96 standard errors of a jackknife over clips. NaN for fewer than two samples on either
        side.
    """
    metric = Metric(name, better="lower")
    description = dict(settings or {}) | {
        "samples": f"{len(generated)} generated, {len(reference)} recorded",
        "dimensions": f"{generated.values.shape[1]}",
        "kernel": "(x·y / d + 1)³, unbiased",
    }
    if min(len(generated), len(reference)) < 2:
        reason = "an unbiased kernel distance needs two samples on either side"
        return metric.missing(reason, description)
    rows, columns = _kernel_sums(generated.values, reference.values)
    sides = _Side.of(generated, rows), _Side.of(reference, columns)
    pairs = len(generated) * len(reference)
    value = float(sides[0].mean + sides[1].mean - 2 * rows.sum() / pairs)
    interval = None
    if all(len(side.rows) >= FEWEST_CLIPS and (side.left >= 2).all() for side in sides):
        error = math.sqrt(sides[0].variance(sides[1]) + sides[1].variance(sides[0]))
        description["interval"] = "± 1.96 standard errors, jackknife over clips"
        interval = (value - 1.96 * error, value + 1.96 * error)
    return metric.score(value, len(generated) + len(reference), description, interval=interval)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Side:
    """Kernel sums of one sample, by clip.

    Attributes
    ----------
    rows : ndarray, shape (C,)
        Rows of each clip.
    touching : ndarray, shape (C,)
        Sum over ordered pairs of different rows with at least one row of the clip.
    total : float
        Sum over all ordered pairs of different rows.
    across : ndarray, shape (C,)
        Sum over pairs of a row of the clip and a row of the other sample.
    """

    rows: Floats
    touching: Floats
    total: float
    across: Floats

    @classmethod
    def of(cls, sample: Embeddings, across: Floats) -> _Side:
        values, clips = sample.values, sample.clips
        sums = _kernel_sums(values, values)[0]
        sums -= (np.einsum("nd,nd->n", values, values) / values.shape[1] + 1) ** 3
        rows = np.bincount(clips).astype(float)
        inside = np.zeros(len(rows))
        for clip in np.flatnonzero(rows > 1):
            kernel = _kernel(values[clips == clip], values[clips == clip])
            inside[clip] = kernel.sum() - np.trace(kernel)
        return cls(
            rows=rows,
            touching=2 * np.bincount(clips, sums) - inside,
            total=float(sums.sum()),
            across=np.asarray(np.bincount(clips, across), float),
        )

    @property
    def left(self) -> Floats:
        """Rows that remain when each clip in turn is left out."""
        return np.asarray(self.rows.sum() - self.rows)

    @property
    def mean(self) -> float:
        """Mean over pairs of different rows."""
        count = self.rows.sum()
        return float(self.total / (count * (count - 1)))

    def variance(self, other: _Side) -> float:
        """Return this sample's contribution to the variance of the distance, by the jackknife."""
        within = (self.total - self.touching) / (self.left * (self.left - 1))
        between = (self.across.sum() - self.across) / (self.left * other.rows.sum())
        without = within + other.mean - 2 * between
        clips = len(self.rows)
        return float((clips - 1) / clips * np.sum((without - without.mean()) ** 2))


def _kernel_sums(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return the sums of the kernel matrix over its columns and over its rows."""
    rows, columns = np.zeros(len(x)), np.zeros(len(y))
    for start in range(0, len(x), _BLOCK):
        kernel = _kernel(x[start : start + _BLOCK], y)
        rows[start : start + _BLOCK] = kernel.sum(axis=1)
        columns += kernel.sum(axis=0)
    return rows, columns


def _kernel(x: Floats, y: Floats) -> Floats:
    return np.asarray((x @ y.T / x.shape[1] + 1) ** 3)
