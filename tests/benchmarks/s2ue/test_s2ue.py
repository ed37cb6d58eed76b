"""The synchrony measure distinguishes faces that move with their bodies from others by timing
alone."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from benchmarks.s2ue.draws import alike
from benchmarks.s2ue.synchrony import FaceBodySynchrony

LANDMARKS = 5


def recordings(seed: int, windows: int = 60) -> NDArray[np.float64]:
    """Return windows in which one curve of three moves both face and body."""
    chance = np.random.default_rng(seed)
    mixing = np.random.default_rng(0).normal(size=(3, 27 + 3 * LANDMARKS))
    mixing[1, 27:] = mixing[2, :27] = 0
    curves = gaussian_filter1d(chance.normal(size=(windows, 30, 3)), 2, axis=1)
    return np.asarray(curves @ mixing)


@pytest.fixture(scope="module")
def synchrony() -> FaceBodySynchrony:
    return FaceBodySynchrony.of(recordings(1))


def test_unseen_recordings_pass_and_other_bodies_fail(
    synchrony: FaceBodySynchrony,
) -> None:
    seen = recordings(2)
    assert synchrony(seen) > 0.9
    assert abs(synchrony(seen, seen[::-1])) < 0.15


def test_delayed_motion_scores_worse(synchrony: FaceBodySynchrony) -> None:
    seen = recordings(2)
    late = np.roll(seen, 6, axis=1)
    assert synchrony(seen, late) < 0.5 * synchrony(seen)


def test_draws_score_one_if_both_change_alike_and_zero_otherwise() -> None:
    chance = np.random.default_rng(1)
    body = chance.normal(size=(12, 40))
    turned = body @ np.linalg.qr(chance.normal(size=(40, 40)))[0]
    other = chance.normal(size=(12, 40))
    assert alike(body, 3 * turned) == pytest.approx(1)
    assert alike(body, other) == pytest.approx(0, abs=0.15)
