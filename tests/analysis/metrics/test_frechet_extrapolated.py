from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.metrics.frechet import frechet_of_samples
from analysis.metrics.frechet_extrapolated import frechet_extrapolated
from analysis.metrics.samples import embeddings


def test_most_of_the_bias_is_gone():
    one, other = np.random.default_rng(0).standard_normal((2, 1000, 16))
    found = frechet_extrapolated(embeddings(one), embeddings(other)).value
    assert abs(found) < 0.25 * frechet_of_samples(one, other)


def test_a_real_distance_stays():
    one, other = np.random.default_rng(1).standard_normal((2, 1000, 8))
    found = frechet_extrapolated(embeddings(one), embeddings(other + 1.0)).value
    assert found == pytest.approx(8, rel=0.1)


def test_too_few_samples_have_no_line_to_extend():
    one, other = np.random.default_rng(2).standard_normal((2, 63, 16))
    found = frechet_extrapolated(embeddings(one), embeddings(other))
    assert math.isnan(found.value)
    assert "63 samples are fewer than 4 x 16 dimensions" in found.reason
