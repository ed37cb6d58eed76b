"""Fréchet distance of embeddings: FGD, FED, FMD and FLD, by a route that is safe at low rank.

The distance of two normal distributions is ``|m₁ - m₂|² + tr Σ₁ + tr Σ₂ - 2 tr √(Σ₁ Σ₂)`` (Dowson &
Landau 1982; Heusel et al. 2017). A matrix square root of the product is slow, and wrong with fewer
samples than dimensions. The last trace is the sum of the singular values of ``A Bᵀ`` for any ``AᵀA
= Σ₁``, ``BᵀB = Σ₂``: here the scaled centred samples if they are fewer than dimensions, and
symmetric square roots otherwise.

Published code takes a matrix square root of the product, and papers report the result;
`published_distance` computes it for comparison.
"""

import math
import warnings
from collections.abc import Mapping
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgWarning, eigh, sqrtm

from analysis.metrics.embeddings import (
    FEWEST_CLIPS,
    SEED,
    Embeddings,
    of_equal_size,
    resampled_clips,
)
from analysis.metrics.scores import Metric, MetricResult
from motion.arrays import Floats

FEWEST_PER_DIMENSION: Final = 2
"""Samples of fewer than this many times the dimensions are flagged."""

RESAMPLES: Final = 200
"""Bootstrap samples for an interval; they determine its standard error to 5%."""

RESAMPLES_OF_MANY: Final = 60
"""The same for more than `MANY` rows, which take seconds each; accurate to 9%."""

MANY: Final = 2000

SIZES: Final = 15
"""Sample sizes for the extrapolation, evenly spaced in 1 / n from n / 2 to n."""

DRAWS: Final = 4
"""Draws per size; their mean is fitted."""


def frechet_of_samples(x: Floats, y: Floats) -> float:
    """Return the Fréchet distance of the normal distributions fitted to two samples.

    Parameters
    ----------
    x, y : ndarray, shape (n, d), (m, d)
        At least two rows each; covariances divide by n - 1 and m - 1.

    Returns
    -------
    float
        In squared units of the embeddings, at least 0.
    """
    means = x.mean(axis=0), y.mean(axis=0)
    first, second = _sample_factor(x - means[0]), _sample_factor(y - means[1])
    shift = means[0] - means[1]
    cross = np.linalg.svd(first @ second.T, compute_uv=False).sum()
    return max(0.0, float(shift @ shift + np.sum(first**2) + np.sum(second**2) - 2 * cross))


def frechet(
    generated: Embeddings,
    reference: Embeddings,
    *,
    name: str = "Fréchet distance",
    settings: Mapping[str, str] | None = None,
) -> MetricResult:
    """Return the distance of the embeddings of generated motion from those of recorded motion.

    Parameters
    ----------
    generated, reference : Embeddings
        Embeddings by the same feature network. The larger sample is cut to the size of the smaller
        one.
    name : str
        The metric's name: FGD (gestures), FED (expressions), FMD (both), FLD (face landmarks).
    settings : mapping, optional
        The feature network and its hash, representation, frame rate, window and stride.

    Returns
    -------
    MetricResult
        Its interval is the score ± 1.96 bootstrap standard errors over clips. It does not correct
        the bias, which the remark estimates for n < 2 d. NaN for fewer than two samples.
    """
    x, y = of_equal_size(generated, reference)
    count, dimensions = x.values.shape
    metric = Metric(name, better="lower")
    description = _description(generated, reference, settings) | {
        "covariance": "unbiased, not regularised"
    }
    if count < 2:
        return metric.missing("a covariance needs two samples", description)
    value = frechet_of_samples(x.values, y.values)
    interval = None
    if min(len(np.unique(sample.clips)) for sample in (x, y)) >= FEWEST_CLIPS:
        resamples = RESAMPLES if count <= MANY else RESAMPLES_OF_MANY
        description["interval"] = f"± 1.96 SD over {resamples} bootstrap samples of clips"
        margin_of_error = 1.96 * _bootstrap_error(x, y, resamples)
        interval = (max(0.0, value - margin_of_error), value + margin_of_error)
    return metric.score(
        value, count, description, interval=interval, remark=_remark(count, dimensions)
    )


def frechet_extrapolated(
    generated: Embeddings,
    reference: Embeddings,
    *,
    name: str = "Fréchet distance, extrapolated",
    settings: Mapping[str, str] | None = None,
) -> MetricResult:
    """Return FGD∞, the Fréchet distance extrapolated to infinitely many samples.

    The bias falls as 1 / n, so the distances of subsamples lie on a line over 1 / n, whose value at
    0 is unbiased (Chong & Forsyth 2020, "Effectively Unbiased FID"). With fewer than twice as many
    samples as dimensions they do not lie on a line.

    Parameters
    ----------
    generated, reference : Embeddings
        Embeddings by the same feature network.
    name : str
        The metric's name.
    settings : mapping, optional
        As in `frechet`.

    Returns
    -------
    MetricResult
        May be below 0 by chance. NaN for fewer samples than four times the dimensions, because half
        of them must still be at least twice the dimensions.
    """
    x, y = of_equal_size(generated, reference)
    count, dimensions = x.values.shape
    metric = Metric(name, better="lower")
    description = _description(generated, reference, settings) | {
        "extrapolation": f"straight line over 1/n through {SIZES} sizes from n/2 to n, "
        f"{DRAWS} draws each",
    }
    if count < 2 * FEWEST_PER_DIMENSION * dimensions:
        reason = f"{count} samples are fewer than 4 x {dimensions} dimensions: no line to extend"
        return metric.missing(reason, description)
    return metric.score(_extrapolated(x, y), count, description)


def _extrapolated(x: Embeddings, y: Embeddings) -> float:
    chance = np.random.default_rng(SEED)
    count = len(x)
    sizes = np.round(1 / np.linspace(1 / count, 2 / count, SIZES)).astype(int)
    distances = []
    for size in sizes:
        draws = [
            frechet_of_samples(
                x.values[chance.choice(count, size, replace=False)],
                y.values[chance.choice(count, size, replace=False)],
            )
            for _ in range(1 if size == count else DRAWS)
        ]
        distances.append(np.mean(draws))
    line = np.polynomial.Polynomial.fit(1 / sizes, distances, deg=1)
    return float(line(0.0))


def _description(
    generated: Embeddings, reference: Embeddings, settings: Mapping[str, str] | None
) -> dict[str, str]:
    count = min(len(generated), len(reference))
    return dict(settings or {}) | {
        "samples": f"{count} of each ({len(generated)} generated, {len(reference)} recorded)",
        "dimensions": f"{reference.values.shape[1]}",
    }


def _remark(count: int, dimensions: int) -> str:
    """Return a warning if a sample is too small for its dimensions."""
    if count >= FEWEST_PER_DIMENSION * dimensions:
        return ""
    return (
        f"{count} samples are fewer than {FEWEST_PER_DIMENSION} x {dimensions} dimensions: two "
        f"samples of one standard normal would score {_bias(count, dimensions):.0f}; compare only "
        "with scores of as many samples, and read the kernel distance as well"
    )


def _bias(count: int, dimensions: int) -> float:
    """Return the mean distance of two samples of one standard normal distribution.

    It is about d (d + 5) / (2 n) for n far above d. For n < d it is simulated: with so many
    dimensions a single draw is close to the mean.
    """
    if count >= dimensions:
        return dimensions * (dimensions + 5) / (2 * count)
    x, y = np.random.default_rng(SEED).standard_normal((2, count, dimensions))
    return frechet_of_samples(x, y)


def _bootstrap_error(x: Embeddings, y: Embeddings, resamples: int) -> float:
    """Return the standard deviation of the distance over bootstrap samples of clips."""
    draws = zip(
        resampled_clips(x, resamples, SEED),
        resampled_clips(y, resamples, SEED + 1),
        strict=True,
    )
    scores = [frechet_of_samples(x.values[rows], y.values[others]) for rows, others in draws]
    return float(np.std(scores, ddof=1))


def _sample_factor(centred: Floats) -> Floats:
    """Return a factor F of min(n, d) rows with FᵀF the covariance of centred samples."""
    count, dimensions = centred.shape
    if count <= dimensions:
        return centred / math.sqrt(count - 1)
    values, vectors = eigh(centred.T @ centred / (count - 1), check_finite=False)
    return np.asarray(np.sqrt(np.clip(values, 0, None))[:, None] * vectors.T)


Rule = Literal["pytorch-fid", "offset"]

RULES: Final[dict[Rule, str]] = {
    "pytorch-fid": "matrix square root of the product of covariances; 1e-6 on the diagonals where "
    "it is not finite; 1e10 where imaginary parts exceed 1e-3",
    "offset": "1e-6 on the diagonals of both covariances, inside the matrix square root alone; "
    "imaginary parts are dropped unseen",
}
"""The rules in words."""

FAILED: Final = 1e10
"""The value that pytorch-fid's rule gives instead of a distance if it fails."""

_OFFSET: Final = 1e-6
_IMAGINARY: Final = 1e-3


def published_distance(x: Floats, y: Floats, rule: Rule) -> float:
    """Return the Fréchet distance of two samples by a published rule.

    If a sample has no more rows than columns, the product is singular, and its root depends on
    SciPy's version and the number of threads; the result may be `FAILED`.

    Parameters
    ----------
    x, y : ndarray, shape (n, d), (m, d)
        At least two rows each.
    rule : {'pytorch-fid', 'offset'}
        See `RULES`.
    """
    shift = x.mean(axis=0) - y.mean(axis=0)
    first, second = (np.atleast_2d(np.cov(sample, rowvar=False)) for sample in (x, y))
    offset = _OFFSET * np.eye(len(first))
    root = _matrix_root(
        (first + offset) @ (second + offset) if rule == "offset" else first @ second
    )
    if rule == "pytorch-fid":
        if not np.isfinite(root).all():
            root = _matrix_root((first + offset) @ (second + offset))
        if np.abs(np.diagonal(root).imag).max() > _IMAGINARY:
            return FAILED
    return float(shift @ shift + np.trace(first) + np.trace(second) - 2 * np.trace(root).real)


def _matrix_root(product: Floats) -> NDArray[np.complex128]:
    with warnings.catch_warnings():
        # The remark about the number of samples states that the product is singular.
        warnings.simplefilter("ignore", LinAlgWarning)
        return np.asarray(sqrtm(product), np.complex128)
