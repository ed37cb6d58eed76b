from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tools.avatars.occlusion import open_sky


def _plate(side: float, height: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return a square of small triangles that faces upwards."""
    count = round(side / 0.008)  # triangles as small as the avatar's
    line = np.linspace(-side / 2, side / 2, count)
    points = np.array([(x, height, z) for z in line for x in line])
    corners = np.array([k * count + j for k in range(count - 1) for j in range(count - 1)])
    a, b, c, d = corners, corners + 1, corners + count + 1, corners + count
    return points, np.concatenate([np.stack([a, c, b], 1), np.stack([a, d, c], 1)])


def test_an_open_plate_sees_the_whole_sky() -> None:
    points, faces = _plate(0.3, 0.0)
    assert open_sky(points, faces).min() > 0.95


def test_a_plate_under_a_close_larger_one_sees_almost_nothing() -> None:
    low, faces = _plate(0.2, 0.0)
    high, roof = _plate(0.6, 0.03)
    sky = open_sky(np.concatenate([low, high]), np.concatenate([faces, roof + len(low)]))
    assert sky[: len(low)].mean() < 0.15
    assert sky[len(low) :].min() > 0.95
