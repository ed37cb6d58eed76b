"""Foot sliding: how fast feet move along the ground while they stand on it.

The speed of each foot counts in full on the ground and fades to nothing at a small height above it
(Zhang et al. 2018, "Mode-adaptive neural networks for quadruped motion control", section 8.1).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.result import Metric, MetricResult

FloatArray = NDArray[np.float64]

FEET: Final = ("left_foot", "right_foot")

CONTACT_HEIGHT: Final = 0.025
"""Metres above the ground below which a foot may be standing."""

_GROUND: Final = 0.02
"""The ground is where this share of the feet's heights lies below: a few damaged frames do not
move it."""


def foot_sliding(positions: FloatArray, *, frame_rate: float) -> MetricResult:
    """Return the mean sliding speed of the feet over frames in which they are on the ground.

    Parameters
    ----------
    positions : ndarray, shape (T, 2, 3)
        Where the joints of `FEET` are in the world, in metres, y up.
    frame_rate : float
        Frames per second.

    Returns
    -------
    MetricResult
        In m/s: horizontal speed between two frames times ``2 - 2 ** (h / H)`` of the greater
        height h above the clip's own ground, over frame pairs with h below H = `CONTACT_HEIGHT`.
        NaN for one frame, and where no foot stays on the ground from one frame to the next.
    """
    described = {
        "joints": ", ".join(FEET),
        "frame rate": f"{frame_rate:g} fps",
        "ground": f"percentile {100 * _GROUND:g} of the heights of the clip's feet",
        "contact": f"within {100 * CONTACT_HEIGHT:g} cm above the ground, weighted 2 - 2^(h/H)",
        "positions": "in the world, default body, metres",
    }
    metric = Metric("foot sliding", "m/s", "lower")
    if len(positions) < 2:
        return metric.missing("a speed needs two frames", described)
    heights = positions[..., 1] - np.quantile(positions[..., 1], _GROUND)
    height = np.maximum(0, np.maximum(heights[1:], heights[:-1]))
    speed = np.linalg.norm(np.diff(positions[..., [0, 2]], axis=0), axis=2) * frame_rate
    standing = height < CONTACT_HEIGHT
    if not standing.any():
        reason = "no foot stays on the ground from one frame to the next"
        return metric.missing(reason, described)
    weight = 2 - 2 ** (height[standing] / CONTACT_HEIGHT)
    return metric.score(float((speed[standing] * weight).mean()), int(standing.sum()), described)
