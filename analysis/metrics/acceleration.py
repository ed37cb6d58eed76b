"""Acceleration: the second derivative of position, as GENEA's evaluations report beside jerk."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.joint_positions import UPPER_BODY_JOINTS
from analysis.metrics.result import MetricResult

_FEWEST_FRAMES: Final = 3


def acceleration(positions: NDArray[np.float64], *, frame_rate: float) -> MetricResult:
    """Return the mean magnitude of the second derivative over frames and joints.

    Parameters
    ----------
    positions : ndarray, shape (T, J, 3)
        Positions of `analysis.metrics.joint_positions.UPPER_BODY_JOINTS` in metres.
    frame_rate : float
        Frames per second.

    Returns
    -------
    MetricResult
        In m/s²: mean norm of second differences times the frame rate squared (Kucherenko et al.
        2021), unfiltered; NaN for a clip of fewer than three frames.
    """
    few = len(positions) < _FEWEST_FRAMES
    second = np.linalg.norm(np.diff(positions, n=2, axis=0), axis=2) * frame_rate**2
    return MetricResult(
        name="acceleration (genea)",
        value=math.nan if few else float(second.mean()),
        unit="m/s²",
        n=0 if few else second.size,
        settings={
            "joints": ", ".join(UPPER_BODY_JOINTS),
            "frame rate": f"{frame_rate:g} fps",
            "filter": "none",
            "positions": "relative to the pelvis, default body, metres",
        },
        reason=f"the clip has fewer than {_FEWEST_FRAMES} frames" if few else "",
        better="near the reference",
    )
