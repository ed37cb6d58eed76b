from __future__ import annotations

import numpy as np
import pytest

from analysis.evaluators.published.published_distance import FAILED, RULES, published_distance
from analysis.metrics.frechet import frechet_of_samples


@pytest.mark.parametrize("rule", RULES)
def test_with_enough_samples_every_rule_gives_our_distance(rule) -> None:  # type: ignore[no-untyped-def]
    random = np.random.default_rng(0)
    one, other = random.standard_normal((300, 8)), 0.5 + 2 * random.standard_normal((200, 8))
    ours = frechet_of_samples(one, other)
    assert published_distance(one, other, rule) == pytest.approx(ours, rel=1e-5)


def test_the_offset_takes_from_small_features_what_the_exact_distance_leaves() -> None:
    random = np.random.default_rng(0)
    one, other = 1e-3 * random.standard_normal((2, 300, 8))
    # Each of 8 dimensions loses 2 (√(s² + 1e-6) - s) with a spread near 1e-3: about 1.6e-5 in all.
    lost = frechet_of_samples(one, other) - published_distance(one, other, "offset")
    assert 1e-5 < lost < 2.5e-5
    assert published_distance(one, other, "pytorch-fid") == pytest.approx(
        frechet_of_samples(one, other), rel=1e-3
    )


def test_a_root_that_is_not_real_is_a_failure_for_pytorch_fid_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    one, other = np.random.default_rng(0).standard_normal((2, 20, 3))
    monkeypatch.setattr(
        "analysis.evaluators.published.published_distance.sqrtm",
        lambda product: product + 0.01j * np.eye(3),
    )
    assert published_distance(one, other, "pytorch-fid") == FAILED
    assert published_distance(one, other, "offset") < 100


def test_a_root_that_is_not_finite_is_taken_again_with_the_offset(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    one, other = np.random.default_rng(0).standard_normal((2, 20, 3))
    roots = iter([np.full((3, 3), np.nan), np.eye(3)])
    monkeypatch.setattr(
        "analysis.evaluators.published.published_distance.sqrtm", lambda product: next(roots)
    )
    assert np.isfinite(published_distance(one, other, "pytorch-fid"))
