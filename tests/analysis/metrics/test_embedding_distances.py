import math
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from scipy.stats import ortho_group

from analysis.metrics.embeddings import Embeddings, embeddings
from analysis.metrics.frechet import (
    FAILED,
    RULES,
    Rule,
    frechet,
    frechet_extrapolated,
    frechet_of_samples,
    published_distance,
)
from analysis.metrics.kernel_distance import kernel_distance
from analysis.metrics.scores import MetricResult
from motion.arrays import Floats


def normal(mean: ArrayLike, covariance: ArrayLike, *, least: int = 0) -> Floats:
    """Return samples with exactly this mean and covariance, `least` or more of them."""
    values, axes = np.linalg.eigh(np.array(covariance, float))
    arms = (axes * np.sqrt(np.maximum(values, 0))).T
    copies = 1 + least // (2 * len(arms))
    both = np.tile(np.concatenate([arms, -arms]), (copies, 1))
    return np.asarray(np.array(mean, float) + both * np.sqrt((len(both) - 1) / (2 * copies)))


@pytest.mark.parametrize("least", [0, 100])
def test_distances_match_their_closed_forms(closed_form: Mapping[str, Any], least: int) -> None:
    for case in closed_form["frechet"]["cases"]:
        one = normal(case["mu1"], case["S1"], least=least)
        other = normal(case["mu2"], case["S2"], least=least)
        scale = np.trace(case["S1"]) + np.trace(case["S2"])
        assert abs(frechet_of_samples(one, other) - case["fd"]) < 1e-9 * scale, case["name"]
        assert abs(frechet_of_samples(other, one) - case["fd"]) < 1e-9 * scale


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([(8, 3), (5, 5), (6, 12), (30, 4)]),
    st.floats(0.1, 10),
)
def test_the_distance_has_the_invariances_of_a_distance(
    seed: int, shape: tuple[int, int], scale: float
) -> None:
    chance = np.random.default_rng(seed)
    one = chance.standard_normal(shape)
    other = 1.5 * chance.standard_normal(shape) + 0.3
    distance = frechet_of_samples(one, other)
    close = partial(pytest.approx, rel=1e-8, abs=1e-9)
    assert frechet_of_samples(one, one) == pytest.approx(0, abs=1e-9)
    assert frechet_of_samples(other, one) == close(distance)
    assert frechet_of_samples(one + 7, other + 7) == close(distance)
    turned = ortho_group.rvs(shape[1], random_state=seed)
    assert frechet_of_samples(one @ turned, other @ turned) == close(distance)
    assert frechet_of_samples(scale * one, scale * other) == close(scale**2 * distance)


def test_small_samples_are_flagged_with_the_score_of_equal_distributions() -> None:
    one, other = np.random.default_rng(2).standard_normal((2, 72, 240))
    found = frechet(embeddings(one), embeddings(other), name="FGD")
    assert found.value == pytest.approx(273, rel=0.05)
    stated = float(found.remark.split("would score ")[1].split(";")[0])
    assert stated == pytest.approx(found.value, rel=0.05)
    one, other = np.random.default_rng(3).standard_normal((2, 500, 32))
    enough = frechet(embeddings(one), embeddings(other))
    assert not enough.remark
    assert enough.value == pytest.approx(32 * 37 / 1000, rel=0.2)


def test_unequal_samples_are_cut_reproducibly_to_equal_ones_with_a_remark() -> None:
    chance = np.random.default_rng(4)
    sides = [embeddings(chance.standard_normal((count, 3))) for count in (40, 25)]
    distance = frechet(*sides)
    assert distance == frechet(*sides)
    assert distance.n == 25
    assert distance.settings["samples"] == "25 of each (40 generated, 25 recorded)"


def test_the_interval_matches_the_variation_between_samples() -> None:
    chance = np.random.default_rng(5)

    def drawn() -> tuple[Embeddings, Embeddings]:
        one, other = chance.standard_normal((2, 100, 5))
        return embeddings(one + np.array([1.0, 0, 0, 0, 0])), embeddings(other)

    samples = [drawn() for _ in range(200)]
    scores = [frechet_of_samples(one.values, other.values) for one, other in samples]
    widths = [width_of(frechet(*sides)) for sides in samples[:10]]
    assert 1 < np.mean(widths) / (2 * 1.96 * np.std(scores)) < 1.4


def test_windows_of_one_clip_are_not_independent_samples() -> None:
    chance = np.random.default_rng(6)
    clip_level = chance.standard_normal((2, 20, 3))
    windows = np.repeat(clip_level, 10, axis=1)
    names = np.repeat(np.arange(20), 10).tolist()
    apart = frechet(*map(embeddings, windows))
    together = frechet(*(embeddings(rows, names) for rows in windows))
    assert width_of(together) > 2 * width_of(apart)


def test_extrapolation_removes_the_bias_and_keeps_a_real_distance() -> None:
    x, y = np.random.default_rng(0).standard_normal((2, 1000, 16))
    without_bias = frechet_extrapolated(embeddings(x), embeddings(y)).value
    assert abs(without_bias) < 0.25 * frechet_of_samples(x, y)
    x, y = np.random.default_rng(1).standard_normal((2, 1000, 8))
    assert frechet_extrapolated(embeddings(x), embeddings(y + 1.0)).value == pytest.approx(8, 0.1)


def test_too_few_samples_have_no_distance() -> None:
    one, few, many = (embeddings(np.zeros((count, 16))) for count in (1, 63, 99))
    for result, reason in (
        (frechet(one, many), "a covariance needs two samples"),
        (kernel_distance(one, many), "needs two samples on either side"),
        (frechet_extrapolated(few, many), "63 samples are fewer than 4 x 16 dimensions"),
    ):
        assert math.isnan(result.value)
        assert reason in result.reason


@pytest.mark.parametrize("rule", RULES)
def test_with_enough_samples_every_rule_gives_our_distance(rule: Rule) -> None:
    random = np.random.default_rng(0)
    one, other = random.standard_normal((300, 8)), 0.5 + 2 * random.standard_normal((200, 8))
    ours = frechet_of_samples(one, other)
    assert published_distance(one, other, rule) == pytest.approx(ours, rel=1e-5)


def test_pytorch_fids_handling_of_bad_matrix_roots_is_reproduced(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    one, other = np.random.default_rng(0).standard_normal((2, 20, 3))
    roots = iter([np.full((3, 3), np.nan), np.eye(3)])
    monkeypatch.setattr("analysis.metrics.frechet.sqrtm", lambda product: next(roots))
    assert np.isfinite(published_distance(one, other, "pytorch-fid"))
    monkeypatch.setattr(
        "analysis.metrics.frechet.sqrtm", lambda product: product + 0.01j * np.eye(3)
    )
    assert published_distance(one, other, "pytorch-fid") == FAILED
    assert published_distance(one, other, "offset") < 100


def distance(one: Floats, other: Floats) -> float:
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

    def kernel(x: Floats, y: Floats) -> float:
        return float((x @ y / 3 + 1) ** 3)

    within = [
        np.mean([kernel(a, b) for i, a in enumerate(s) for j, b in enumerate(s) if i != j])
        for s in (one, other)
    ]
    across = np.mean([kernel(a, b) for a in one for b in other])
    assert distance(one, other) == pytest.approx(sum(within) - 2 * across)
