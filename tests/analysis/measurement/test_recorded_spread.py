from collections.abc import Iterator

import numpy as np
import pytest

from analysis.measurement.recorded_spread import ClipExtent, recorded_spread
from motion.arrays import Floats


def clips() -> Iterator[tuple[Floats, Floats]]:
    chance = np.random.default_rng(0)
    for frames in (30, 50):
        rotations = chance.normal(0.4, 0.2, (frames, 3, 3))
        rotations[:, 1] = 0.7
        rotations[:, 2, 0] = -0.1
        yield rotations, chance.normal(0, 1, (frames, 5, 3))


def test_the_spread_covers_all_frames_and_skips_still_joints() -> None:
    spread = recorded_spread(ClipExtent.of(*clip) for clip in clips())
    assert spread is not None
    rotations = np.concatenate([rotations for rotations, _ in clips()])
    positions = np.concatenate([positions.reshape(-1, 3) for _, positions in clips()])
    np.testing.assert_allclose(spread.mean, rotations.mean(axis=0))
    np.testing.assert_allclose(spread.deviation[0], rotations[:, 0].std(axis=0))
    assert np.linalg.norm(np.ptp(positions, axis=0)) * spread.scale == pytest.approx(1)
    assert spread.moving.tolist() == [True, False, True]
    # A channel that stays still is measured in radians.
    assert spread.deviation[2, 0] == 1
    standard = spread.normalised(rotations)
    assert standard.shape == (80, 2, 3)
    np.testing.assert_allclose(standard[:, 0].std(axis=0), 1)
    assert np.abs(standard[:, 1, 0]).max() < 1e-9


def test_without_recordings_or_movement_there_is_no_spread() -> None:
    assert recorded_spread([]) is None
    point = ClipExtent.of(np.zeros((4, 2, 3)), np.ones((4, 2, 3)))
    assert recorded_spread([point]) is None
