"""Kernel distance of embeddings (KID): unbiased at any sample size, so it may be below 0.

The squared maximum mean discrepancy with the kernel ``k(x, y) = (x·y / d + 1)³`` (Bińkowski et al.
2018, "Demystifying MMD GANs"). It accompanies every Fréchet distance.
"""

from collections.abc import Mapping
from typing import Final

import numpy as np

from analysis.metrics.embeddings import Embeddings
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
        0 on average for equal distributions, so single scores may be negative. NaN for fewer than
        two samples on either side.
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
    within = [_mean_kernel(values, values) for values in (generated.values, reference.values)]
    across = _mean_kernel(generated.values, reference.values)
    value = within[0] + within[1] - 2 * across
    return metric.score(value, len(generated) + len(reference), description)


def _mean_kernel(x: Floats, y: Floats) -> float:
    """Return the mean of the kernel over all pairs of rows; of a sample with itself, different."""
    total = 0.0
    for start in range(0, len(x), _BLOCK):
        total += float(((x[start : start + _BLOCK] @ y.T / x.shape[1] + 1) ** 3).sum())
    if x is y:
        total -= float(((np.einsum("nd,nd->n", x, x) / x.shape[1] + 1) ** 3).sum())
        return total / (len(x) * (len(x) - 1))
    return total / (len(x) * len(y))
