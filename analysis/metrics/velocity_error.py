"""Velocity errors: how much slower, faster or elsewhere each joint moves than in the recording."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.pairing import paired
from analysis.metrics.result import MetricResult

FloatArray = NDArray[np.float64]
Norm = Literal["L1", "L2"]


def velocity_error(
    generated: FloatArray,
    recorded: FloatArray,
    *,
    frame_rate: float,
    norm: Norm,
    settings: Mapping[str, str] | None = None,
) -> MetricResult:
    """Return the mean distance between the velocities of two motions.

    Parameters
    ----------
    generated, recorded : ndarray, shape (T, J, 3)
        Positions in metres.
    frame_rate : float
        Frames per second of both.
    norm : {'L1', 'L2'}
        L1: mean absolute difference of velocity components. L2: mean length of the difference
        of velocity vectors.
    settings : mapping, optional
        What the positions are.

    Returns
    -------
    MetricResult
        In m/s; 0 for the recording itself. NaN where the clips do not pair, and for one frame.
    """
    one, other, reason = paired(generated, recorded)
    if not reason and len(one) < 2:
        reason = "a velocity needs two frames"
    value, count = math.nan, 0
    if not reason:
        difference = np.diff(one - other, axis=0) * frame_rate
        size = np.abs(difference) if norm == "L1" else np.linalg.norm(difference, axis=2)
        value, count = float(size.mean()), difference.shape[0] * difference.shape[1]
    averaged = "components" if norm == "L1" else "vectors"
    return MetricResult(
        name=f"velocity error ({norm})",
        value=value,
        unit="m/s",
        n=count,
        settings=dict(settings or {})
        | {"frame rate": f"{frame_rate:g} fps", "mean over": f"frames, joints and {averaged}"},
        reason=reason,
        better="lower",
    )
