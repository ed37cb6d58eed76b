"""FGD∞: the Fréchet distance that infinitely many samples would have.

The bias falls as 1 / n, so that the distances of smaller and smaller parts of the samples lie on a
line over 1 / n whose value at 0 is free of it (Chong & Forsyth 2020, "Effectively Unbiased FID").
Below twice as many samples as dimensions there is no such line.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

import numpy as np

from analysis.metrics.frechet import FEWEST_PER_DIMENSION, frechet_of_samples
from analysis.metrics.result import MetricResult
from analysis.metrics.samples import SEED, Embeddings, check_dimensions, of_equal_size

SIZES: Final = 15
"""Sizes at which the distance is computed, evenly spaced in 1 / n from half of the samples on."""

DRAWS: Final = 4
"""Draws per size, whose mean enters the line."""


def frechet_extrapolated(
    generated: Embeddings,
    reference: Embeddings,
    *,
    name: str = "Fréchet distance, extrapolated",
    settings: Mapping[str, str] | None = None,
) -> MetricResult:
    """Return the Fréchet distance extrapolated to infinitely many samples.

    Parameters
    ----------
    generated, reference : Embeddings
        Of the same feature network.
    name : str
        What the embeddings are of.
    settings : mapping, optional
        As for `analysis.metrics.frechet.frechet`.

    Returns
    -------
    MetricResult
        May be below 0 by chance, and is not cut off there. NaN for fewer samples than four times
        the dimensions: half of them must still be twice the dimensions.
    """
    check_dimensions(generated, reference)
    one, other = of_equal_size(generated, reference)
    count, dimensions = one.values.shape
    least = 2 * FEWEST_PER_DIMENSION * dimensions
    described = dict(settings or {}) | {
        "samples": f"{count} of each ({len(generated)} generated, {len(reference)} recorded)",
        "dimensions": f"{dimensions}",
        "extrapolation": f"straight line over 1/n through {SIZES} sizes from n/2 to n, "
        f"{DRAWS} draws each",
    }
    reason = ""
    if count < least:
        reason = f"{count} samples are fewer than 4 x {dimensions} dimensions: no line to extend"
    value = math.nan if reason else _at_infinity(one, other)
    return MetricResult(
        name=name,
        value=value,
        unit="",
        n=count,
        settings=described,
        reason=reason,
        better="lower",
    )


def _at_infinity(one: Embeddings, other: Embeddings) -> float:
    chance = np.random.default_rng(SEED)
    count = len(one)
    sizes = np.round(1 / np.linspace(1 / count, 2 / count, SIZES)).astype(int)
    distances = []
    for size in sizes:
        drawn = [
            frechet_of_samples(
                one.values[chance.choice(count, size, replace=False)],
                other.values[chance.choice(count, size, replace=False)],
            )
            for _ in range(1 if size == count else DRAWS)
        ]
        distances.append(np.mean(drawn))
    line = np.polynomial.Polynomial.fit(1 / sizes, distances, deg=1)
    return float(line(0.0))
