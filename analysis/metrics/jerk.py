"""Jerk: the third derivative of position, large where motion trembles or jumps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from analysis.metrics.joint_positions import UPPER_BODY_JOINTS, WRISTS
from analysis.metrics.result import MetricResult

_FILTER_ORDER: Final = 4
_FEWEST_FRAMES: Final = 16


@dataclass(frozen=True, kw_only=True)
class JerkSettings:
    """What makes a jerk comparable with another, besides the frame rate.

    Attributes
    ----------
    name : str
        Names the preset.
    joints : tuple of str
        The joints measured.
    cutoff : float or None
        Cut-off of the low-pass filter in Hz (Butterworth, order 4, forwards and backwards); None
        for no filter. Third differences amplify sensor noise by the frame rate cubed.
    """

    name: str
    joints: tuple[str, ...]
    cutoff: float | None


HANDS: Final = JerkSettings(name="hands", joints=WRISTS, cutoff=6.0)
"""Wrists, low-pass at 6 Hz: gestures pass, frame-to-frame jitter at 15 fps and more does not."""

HANDS_UNFILTERED: Final = JerkSettings(name="hands, unfiltered", joints=WRISTS, cutoff=None)
"""Wrists as they are; jitter counts in full, and so does noise of the recording."""

GENEA: Final = JerkSettings(name="genea", joints=UPPER_BODY_JOINTS, cutoff=None)
"""GENEA's evaluation: all joints, here those of head and arms, without a filter."""


def jerk(
    positions: NDArray[np.float64], *, frame_rate: float, settings: JerkSettings
) -> MetricResult:
    """Return the mean magnitude of the third derivative over frames and joints.

    Parameters
    ----------
    positions : ndarray, shape (T, J, 3)
        Positions of `settings.joints` in metres.
    frame_rate : float
        Frames per second.
    settings : JerkSettings
        Which joints these are, and how they are filtered.

    Returns
    -------
    MetricResult
        In m/s³: mean norm of third differences times the frame rate cubed, as GENEA's evaluation
        (Kucherenko et al. 2021); NaN for a clip of fewer than 16 frames, and where the cut-off
        is not below half the frame rate.
    """
    described = {
        "joints": ", ".join(settings.joints),
        "frame rate": f"{frame_rate:g} fps",
        "filter": "none"
        if settings.cutoff is None
        else f"Butterworth low-pass, order {_FILTER_ORDER}, {settings.cutoff:g} Hz, zero phase",
        "positions": "relative to the pelvis, default body, metres",
    }
    name, unit = f"jerk ({settings.name})", "m/s³"
    reason = ""
    if len(positions) < _FEWEST_FRAMES:
        reason = f"the clip has fewer than {_FEWEST_FRAMES} frames"
    elif settings.cutoff is not None and settings.cutoff >= frame_rate / 2:
        reason = f"{frame_rate:g} fps is too slow for a {settings.cutoff:g} Hz filter"
    if reason:
        return MetricResult(
            name=name,
            value=math.nan,
            unit=unit,
            n=0,
            settings=described,
            reason=reason,
            better="near the reference",
        )
    smooth = positions
    if settings.cutoff is not None:
        sections = butter(_FILTER_ORDER, settings.cutoff, fs=frame_rate, output="sos")
        smooth = sosfiltfilt(sections, positions, axis=0)
    third = np.linalg.norm(np.diff(smooth, n=3, axis=0), axis=2) * frame_rate**3
    return MetricResult(
        name=name,
        value=float(third.mean()),
        unit=unit,
        n=third.size,
        settings=described,
        better="near the reference",
    )
