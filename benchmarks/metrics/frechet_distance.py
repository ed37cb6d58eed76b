"""Speed of the Fréchet distance: ``python -m benchmarks.metrics.frechet_distance``.

Prints ``name: value`` lines. It is timed in turns with the textbook's, which takes scipy's matrix
square root of the product of both covariances, in one process on the same samples.
"""

import time
from collections.abc import Callable
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import sqrtm

from analysis.metrics.frechet import frechet_of_samples

FloatArray = NDArray[np.float64]

SHAPES: Final = ((72, 240), (72, 256), (200, 300), (1000, 32), (2000, 300))
"""Samples and dimensions, AMUSE's 72 clips among them."""

_TURNS: Final = 11
"""Repetitions, of which the fastest counts: other work of a machine only adds time."""


def textbook_frechet(samples: FloatArray, others: FloatArray) -> float:
    """Return the Fréchet distance by the matrix square root of the covariances' product."""
    shift = samples.mean(axis=0) - others.mean(axis=0)
    first, second = np.cov(samples, rowvar=False), np.cov(others, rowvar=False)
    root = np.real(sqrtm(first @ second))
    return float(shift @ shift + np.trace(first) + np.trace(second) - 2 * np.trace(root))


def main() -> None:
    """Print milliseconds, their ratio, and the distance of a sample from itself by both."""
    chance = np.random.default_rng(0)
    for count, dimensions in SHAPES:
        samples, others = chance.standard_normal((2, count, dimensions))
        ours, textbook = _least(
            partial(frechet_of_samples, samples, others), partial(textbook_frechet, samples, others)
        )
        prefix = f"frechet_n{count}_d{dimensions}"
        print(f"{prefix}_ms: {1000 * ours:.3g}")
        print(f"{prefix}_sqrtm_ms: {1000 * textbook:.3g}")
        print(f"{prefix}_times_faster: {textbook / ours:.1f}")
        print(f"{prefix}_self_distance: {frechet_of_samples(samples, samples):.1e}")
        print(f"{prefix}_sqrtm_self_distance: {textbook_frechet(samples, samples):.1e}")


def _least(*functions: Callable[[], object]) -> list[float]:
    """Return each function's fastest time in seconds; they are called in turns."""
    seconds: list[list[float]] = [[] for _ in functions]
    for _ in range(_TURNS):
        for taken, function in zip(seconds, functions, strict=True):
            began = time.perf_counter()
            function()
            taken.append(time.perf_counter() - began)
    return [min(taken) for taken in seconds]


if __name__ == "__main__":
    main()
