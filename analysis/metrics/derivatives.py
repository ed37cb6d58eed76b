"""Jerk and acceleration: derivatives of position, large where motion trembles or jumps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from analysis.metrics.joint_positions import UPPER_BODY_JOINTS, WRISTS
from analysis.metrics.result import Metric, MetricResult

_FILTER_ORDER: Final = 4


@dataclass(frozen=True, kw_only=True)
class DerivativeSettings:
    """What makes a jerk or an acceleration comparable with another, besides the frame rate.

    Attributes
    ----------
    name, unit : str
        Of the metric.
    order : int
        Which derivative: 2 for acceleration, 3 for jerk.
    joints : tuple of str
        The joints measured.
    cutoff : float or None
        Cut-off of the low-pass filter in Hz (Butterworth, order 4, forwards and backwards); None
        for no filter. Third differences amplify sensor noise by the frame rate cubed.
    fewest : int
        Frames that a clip must have.
    """

    name: str
    unit: str = "m/s³"
    order: int = 3
    joints: tuple[str, ...]
    cutoff: float | None = None
    fewest: int = 16


HANDS: Final = DerivativeSettings(name="jerk (hands)", joints=WRISTS, cutoff=6.0)
"""Wrists, low-pass at 6 Hz: gestures pass, frame-to-frame jitter at 15 fps and more does not."""

HANDS_UNFILTERED: Final = DerivativeSettings(name="jerk (hands, unfiltered)", joints=WRISTS)
"""Wrists as they are; jitter counts in full, and so does noise of the recording."""

GENEA: Final = DerivativeSettings(name="jerk (genea)", joints=UPPER_BODY_JOINTS)
"""GENEA's evaluation: all joints, here those of head and arms, without a filter."""

GENEA_ACCELERATION: Final = DerivativeSettings(
    name="acceleration (genea)", unit="m/s²", order=2, joints=UPPER_BODY_JOINTS, fewest=3
)


def mean_derivative(
    positions: NDArray[np.float64], *, frame_rate: float, settings: DerivativeSettings
) -> MetricResult:
    """Return the mean magnitude of a derivative of position over frames and joints.

    Parameters
    ----------
    positions : ndarray, shape (T, J, 3)
        Positions of `settings.joints` in metres.
    frame_rate : float
        Frames per second.
    settings : DerivativeSettings
        Which derivative, which joints these are, and how they are filtered.

    Returns
    -------
    MetricResult
        In m/s² or m/s³: mean norm of second or third differences times that power of the frame
        rate, as GENEA's evaluation (Kucherenko et al. 2021); NaN for a clip of too few frames, and
        where the cut-off is not below half the frame rate.
    """
    metric = Metric(settings.name, settings.unit, "near the reference")
    cutoff, order = settings.cutoff, settings.order
    described = {
        "joints": ", ".join(settings.joints),
        "frame rate": f"{frame_rate:g} fps",
        "filter": "none"
        if cutoff is None
        else f"Butterworth low-pass, order {_FILTER_ORDER}, {cutoff:g} Hz, zero phase",
        "positions": "relative to the pelvis, default body, metres",
    }
    if len(positions) < settings.fewest:
        return metric.missing(f"the clip has fewer than {settings.fewest} frames", described)
    if cutoff is not None:
        if cutoff >= frame_rate / 2:
            reason = f"{frame_rate:g} fps is too slow for a {cutoff:g} Hz filter"
            return metric.missing(reason, described)
        sections = butter(_FILTER_ORDER, cutoff, fs=frame_rate, output="sos")
        positions = sosfiltfilt(sections, positions, axis=0)
    sizes = np.linalg.norm(np.diff(positions, n=order, axis=0), axis=2) * frame_rate**order
    return metric.score(float(sizes.mean()), sizes.size, described)
