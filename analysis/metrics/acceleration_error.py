"""Mean acceleration error (MAcE): whether motion has regressed to its mean.

Speech2UnifiedExpressions (Bhattacharya et al. 2024, section 6.2) in mm/s². Code of its predecessor
leaves out the frame rate, which makes values of other frame rates incomparable; it is in here.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.absolute_error import SEED_FRAMES, PointSettings
from analysis.metrics.pairing import paired
from analysis.metrics.result import MetricResult

FloatArray = NDArray[np.float64]

MACE_POSES: Final = PointSettings(
    name="MAcE-P, s2ue", points="joints of the default body", seed_frames=SEED_FRAMES
)

MACE_LANDMARKS: Final = PointSettings(
    name="MAcE-LM, s2ue", points="face landmarks", seed_frames=SEED_FRAMES
)

_FEWEST_FRAMES: Final = 3


def acceleration_error(
    generated: FloatArray,
    recorded: FloatArray,
    *,
    frame_rate: float,
    settings: PointSettings,
    scale: float = 1.0,
    missing: str = "",
) -> MetricResult:
    """Return the mean absolute difference of the coordinates' accelerations.

    Parameters
    ----------
    generated, recorded : ndarray, shape (T, P, 3)
        Points in metres.
    frame_rate : float
        Frames per second of both.
    settings : PointSettings
        `MACE_POSES` or `MACE_LANDMARKS`.
    scale : float
        Factor that all points are multiplied by (`analysis.metrics.absolute_error.box_scale`).
    missing : str
        Why there are no points, where there are none.

    Returns
    -------
    MetricResult
        In mm/s²: second differences times the frame rate squared. NaN where the clips do not pair
        or fewer than three frames are left.
    """
    one, other, reason = paired(generated, recorded)
    reason = missing or reason
    one, other = one[settings.seed_frames :], other[settings.seed_frames :]
    if not reason and len(one) < _FEWEST_FRAMES:
        reason = f"the clip has fewer than {_FEWEST_FRAMES} frames behind those that seed"
    value, count = math.nan, 0
    if not reason:
        second = np.diff(one - other, n=2, axis=0) * frame_rate**2
        value = 1000 * scale * float(np.abs(second).mean())
        count = second.shape[0] * second.shape[1]
    return MetricResult(
        name=f"mean acceleration error ({settings.name})",
        value=value,
        unit="mm/s²",
        n=count,
        settings=settings.described(frame_rate, scale),
        reason=reason,
        better="lower",
    )
