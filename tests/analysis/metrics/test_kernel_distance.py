from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from analysis.metrics.embeddings import embeddings
from analysis.metrics.kernel_distance import kernel_distance
from analysis.metrics.scores import MetricResult

FloatArray = NDArray[np.float64]


def distance(one: FloatArray, other: FloatArray) -> float:
    return kernel_distance(embeddings(one), embeddings(other)).value


def width_of(found: MetricResult) -> float:
    """Return how wide a score's interval is."""
    assert found.interval is not None
    return found.interval[1] - found.interval[0]


def test_point_masses_agree_with_their_closed_form(closed_form: Mapping[str, Any]) -> None:
    expected = closed_form["kid"]
    one, other = (np.tile(expected[key], (count, 1)) for key, count in (("x", 4), ("y", 7)))
    assert distance(one, other) == pytest.approx(expected["value"])


def test_it_equals_the_definitions_mean_over_pairs() -> None:
    one, other = np.random.default_rng(1).standard_normal((2, 6, 3))

    def kernel(x: FloatArray, y: FloatArray) -> float:
        return float((x @ y / 3 + 1) ** 3)

    within = [
        np.mean([kernel(a, b) for i, a in enumerate(s) for j, b in enumerate(s) if i != j])
        for s in (one, other)
    ]
    across = np.mean([kernel(a, b) for a in one for b in other])
    assert distance(one, other) == pytest.approx(sum(within) - 2 * across)


def test_the_interval_matches_the_variation_between_samples() -> None:
    chance = np.random.default_rng(2)
    found = [
        kernel_distance(embeddings(one + 0.5), embeddings(other))
        for one, other in (chance.standard_normal((2, 60, 4)) for _ in range(150))
    ]
    reach = np.mean([width_of(f) / 2 for f in found])
    assert reach / (1.96 * np.std([f.value for f in found])) == pytest.approx(1, abs=0.25)


def test_leaving_out_a_clip_leaves_out_all_its_windows() -> None:
    chance = np.random.default_rng(3)
    clips = chance.standard_normal((2, 12, 3))
    names = np.repeat(np.arange(12), 4).tolist()
    windows = np.repeat(clips, 4, axis=1)
    together = kernel_distance(*(embeddings(rows, names) for rows in windows))
    apart = kernel_distance(*map(embeddings, windows))
    assert together.value == pytest.approx(apart.value)
    width, narrow = map(width_of, (together, apart))
    assert width > 1.7 * narrow
