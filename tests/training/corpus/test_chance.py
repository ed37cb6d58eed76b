from __future__ import annotations

import numpy as np
import pytest

from training.corpus.chance import EXPECTED, Chance


def test_without_chance_everything_is_as_it_is_on_average() -> None:
    drawn = [Chance(seed=(seed,)).strokes(40) for seed in range(400)]
    expected = EXPECTED.strokes(40)
    gains = np.mean([one.gains for one in drawn], axis=(0, 1))
    np.testing.assert_allclose(gains, expected.gains[0], rtol=0.03)
    assert np.mean([one.delays for one in drawn]) == pytest.approx(0, abs=0.001)
    times = np.arange(30) / 10
    assert not EXPECTED.drift(times, 3, 1).any()
    assert not len(EXPECTED.blinks(100.0))


def test_drift_has_the_stated_mean_and_variance_at_any_frame_rate() -> None:
    chance = Chance(seed=(1, 2))
    slow, fast = (chance.drift(np.arange(rate * 600) / rate, 50, 1) for rate in (10, 20))
    np.testing.assert_allclose(fast[::2], slow, atol=1e-9)
    assert slow.mean() == pytest.approx(0, abs=0.02)
    assert slow.var() == pytest.approx(1, rel=0.05)


def test_the_same_seed_draws_the_same_and_another_one_something_else() -> None:
    one, again, other = (Chance(seed=seed).strokes(9) for seed in ((1, 7), (1, 7), (1, 8)))
    assert np.array_equal(one.gains, again.gains)
    assert not np.array_equal(one.gains, other.gains)
