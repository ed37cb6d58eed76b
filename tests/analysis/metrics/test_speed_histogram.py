from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.metrics.speed_histogram import speed_counts, speed_distance


def at_speed(speed, *, frames=31, joints=2, frame_rate=30.0):
    """Return joints that all move along x at one speed."""
    x = np.arange(frames)[:, None] * speed / frame_rate
    return np.stack([np.broadcast_to(x, (frames, joints))] + [np.zeros((frames, joints))] * 2, 2)


def test_every_frame_is_in_the_bin_of_its_speed_and_the_last_bin_is_open():
    counts = speed_counts(np.concatenate([at_speed(0.12), at_speed(99.0)], axis=1), 30.0)
    assert counts.shape == (4, 80)
    assert counts[0, 2] == counts[2, 79] == 30
    assert counts.sum() == 4 * 30


def test_equal_histograms_are_at_distance_0_and_disjoint_ones_at_1():
    slow, fast = (np.stack([speed_counts(at_speed(v), 30.0)] * 6) for v in (0.12, 0.52))
    same = speed_distance(slow, slow, frame_rate=30.0)
    assert (same.value, same.interval) == (0, (0, 0))
    assert speed_distance(slow, fast, frame_rate=30.0).value == 1


def test_the_distance_is_hellingers():
    one, other = np.zeros((2, 1, 1, 80), int)
    one[0, 0, :2], other[0, 0, :2] = (1, 3), (3, 1)
    found = speed_distance(one, other, frame_rate=30.0)
    assert found.value == pytest.approx(math.sqrt(1 - math.sqrt(3) / 2))
    assert found.interval is None


def test_single_frames_have_no_speed():
    none = speed_counts(at_speed(1.0, frames=1), 30.0)[None]
    found = speed_distance(none, none, frame_rate=30.0)
    assert math.isnan(found.value)
    assert "two frames" in found.reason
