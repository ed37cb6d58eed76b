"""The Fréchet distance as published code computes it, to stand beside ours.

Ours (`analysis.metrics.frechet`) is exact at any rank. Published code takes a matrix square root of
the product of two covariances, and papers' numbers hold whatever comes of that.
"""

from __future__ import annotations

import warnings
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgWarning, sqrtm

FloatArray = NDArray[np.float64]
Rule = Literal["pytorch-fid", "offset"]

RULES: Final[dict[Rule, str]] = {
    "pytorch-fid": "matrix square root of the product of covariances; 1e-6 on the diagonals where "
    "it is not finite; 1e10 where imaginary parts exceed 1e-3",
    "offset": "1e-6 on the diagonals of both covariances, inside the matrix square root alone; "
    "imaginary parts are dropped unseen",
}
"""What each rule does, in words."""

FAILED: Final = 1e10
"""What the rule of pytorch-fid says in place of a distance."""

_OFFSET: Final = 1e-6
_IMAGINARY: Final = 1e-3


def published_distance(one: FloatArray, other: FloatArray, rule: Rule) -> float:
    """Return the Fréchet distance of two samples by a published rule.

    Where a sample has no more rows than columns the product is singular, and its root depends on
    SciPy's version and on the number of threads; `FAILED` may come of it.

    Parameters
    ----------
    one, other : ndarray, shape (n, d), (m, d)
        At least two rows each.
    rule : {'pytorch-fid', 'offset'}
        Which; see `RULES`.
    """
    shift = one.mean(axis=0) - other.mean(axis=0)
    first, second = (np.atleast_2d(np.cov(sample, rowvar=False)) for sample in (one, other))
    offset = _OFFSET * np.eye(len(first))
    root = _root((first + offset) @ (second + offset) if rule == "offset" else first @ second)
    if rule == "pytorch-fid":
        if not np.isfinite(root).all():
            root = _root((first + offset) @ (second + offset))
        if np.abs(np.diagonal(root).imag).max() > _IMAGINARY:
            return FAILED
    return float(shift @ shift + np.trace(first) + np.trace(second) - 2 * np.trace(root).real)


def _root(product: FloatArray) -> NDArray[np.complex128]:
    with warnings.catch_warnings():
        # That the product is singular is said with the number of samples.
        warnings.simplefilter("ignore", LinAlgWarning)
        return np.asarray(sqrtm(product), np.complex128)
