"""Mean absolute error of joints (MAJE) and of face landmarks (MALE).

Speech2UnifiedExpressions (Bhattacharya et al. 2024, section 6.2) after Yoon et al. 2020: mean
absolute difference of coordinates, in millimetres, after all motion is scaled by one constant into
a box with a diagonal of one metre. Frames that seed the generator are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.pairing import paired
from analysis.metrics.result import MetricResult

FloatArray = NDArray[np.float64]

SEED_FRAMES: Final = 4
"""Frames that S2UE and its predecessors give their generators to begin with, at 15 fps."""

S2UE_FRAME_RATE: Final = 15.0


@dataclass(frozen=True, kw_only=True)
class PointSettings:
    """Which points are compared, and from which frame on.

    Attributes
    ----------
    name : str
        Abbreviation and preset, such as ``MAJE, s2ue``.
    points : str
        What the points are.
    seed_frames : int
        Frames at the start that are left out.
    """

    name: str
    points: str
    seed_frames: int = 0

    def described(self, frame_rate: float, scale: float) -> dict[str, str]:
        """Return the settings in words, for a footnote."""
        known = math.isfinite(scale)
        return {
            "points": self.points,
            "scale": f"{scale:.4g}, the same for all clips" if known else "none: no points",
            "frame rate": f"{frame_rate:g} fps",
            "left out": f"the first {self.seed_frames} frames" if self.seed_frames else "nothing",
        }


MAJE: Final = PointSettings(
    name="MAJE, s2ue", points="joints of the default body", seed_frames=SEED_FRAMES
)

MALE: Final = PointSettings(name="MALE, s2ue", points="face landmarks", seed_frames=SEED_FRAMES)


def box_scale(clips: Iterable[FloatArray]) -> float:
    """Return the factor that puts all points of all clips into a box of one metre diagonal.

    Parameters
    ----------
    clips : iterable of ndarray, shape (T, P, 3)
        Points in metres.

    Raises
    ------
    ValueError
        If there is no clip, or all points are one.
    """
    corners = [(clip.min(axis=(0, 1)), clip.max(axis=(0, 1))) for clip in clips]
    if not corners:
        raise ValueError("no clip to put into a box")
    low = np.min([corner[0] for corner in corners], axis=0)
    high = np.max([corner[1] for corner in corners], axis=0)
    diagonal = float(np.linalg.norm(high - low))
    if not diagonal > 0:
        raise ValueError("all points are one")
    return 1 / diagonal


def absolute_error(
    generated: FloatArray,
    recorded: FloatArray,
    *,
    frame_rate: float,
    settings: PointSettings,
    scale: float = 1.0,
    missing: str = "",
) -> MetricResult:
    """Return the mean absolute difference of coordinates.

    Parameters
    ----------
    generated, recorded : ndarray, shape (T, P, 3)
        Points in metres.
    frame_rate : float
        Frames per second of both.
    settings : PointSettings
        `MAJE` or `MALE`.
    scale : float
        Factor that all points are multiplied by; see `box_scale`.
    missing : str
        Why there are no points, where there are none.

    Returns
    -------
    MetricResult
        In mm; 0 for the recording itself. NaN where the clips do not pair or only seed frames are
        there.
    """
    one, other, reason = paired(generated, recorded)
    reason = missing or reason
    one, other = one[settings.seed_frames :], other[settings.seed_frames :]
    if not reason and not one.size:
        reason = "the clip has no frame behind those that seed the generator"
    value = math.nan if reason else 1000 * scale * float(np.abs(one - other).mean())
    return MetricResult(
        name=f"mean absolute error ({settings.name})",
        value=value,
        unit="mm",
        n=0 if reason else one.shape[0] * one.shape[1],
        settings=settings.described(frame_rate, scale),
        reason=reason,
        better="lower",
    )
