import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.metrics.diversity import (
    feature_variance,
    l1_deviation,
    mean_pair_distance,
    motion_features,
)


def test_distances_agree_with_their_closed_forms(closed_form: Mapping[str, Any]) -> None:
    expected = closed_form["diversity"]
    half = expected["n"] // 2
    features = np.array([[0.0]] * half + [[float(expected["D"])]] * half)
    assert mean_pair_distance(features).value == pytest.approx(expected["value"])
    sample = np.random.default_rng(0).normal(0, expected["s"], (2000, expected["d"]))
    assert mean_pair_distance(sample).value == pytest.approx(expected["value_gauss"], rel=0.01)
    l1 = expected["d"] * expected["s"] * math.sqrt(2 / math.pi)
    assert l1_deviation(sample).value == pytest.approx(l1, rel=0.02)


def test_the_distance_between_clips_is_a_root_mean_square_in_metres() -> None:
    still = np.zeros((20, 5, 3))
    apart = np.zeros((25, 5, 3))
    apart[..., 1] = 0.3
    features = motion_features([still, apart])
    assert features.shape == (2, 20 * 5 * 3)
    assert mean_pair_distance(features).value == pytest.approx(0.3)


def test_feature_variance_matches_a_normal_sample_and_needs_two_clips() -> None:
    features = np.random.default_rng(2).normal(3, 1.5, (4000, 6))
    assert feature_variance(features).value == pytest.approx(1.5**2, rel=0.03)
    two = feature_variance(features[:2]).value
    assert two == pytest.approx(((features[0] - features[1]) ** 2 / 2).mean())
    for alone in (feature_variance(features[:1]), mean_pair_distance(features[:1])):
        assert math.isnan(alone.value)
        assert "needs two clips" in alone.reason


@given(st.integers(0, 2**32 - 1), st.floats(0.1, 10))
def test_diversity_ignores_shifts_and_grows_with_scale(seed: int, scale: float) -> None:
    sample = np.random.default_rng(seed).standard_normal((6, 4))
    for measure, power in ((l1_deviation, 1), (mean_pair_distance, 1), (feature_variance, 2)):
        value = measure(sample).value
        assert measure(sample + 3).value == pytest.approx(value)
        assert measure(scale * sample).value == pytest.approx(scale**power * value)
