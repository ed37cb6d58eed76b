"""Errors of points compared with the recording of the same speech.

Mean absolute error of joints (MAJE) and of face landmarks (MALE) and mean acceleration error
(MAcE): Speech2UnifiedExpressions (Bhattacharya et al. 2024, section 6.2) after Yoon et al. 2020, in
millimetres, after one constant has scaled all motion into a box with a diagonal of one metre.
Frames that seed the generator are left out. Its predecessor's code omits the frame rate from
accelerations, so values at different frame rates are not comparable; here the frame rate is
included.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from analysis.metrics.scores import Metric, MetricResult
from motion.arrays import Floats

Norm = Literal["L1", "L2"]

LEAST_OVERLAP: Final = 0.9
"""A clip shorter than this share of the other is not the same segment."""

SEED_FRAMES: Final = 4
"""Seed frames of the generators of S2UE and its predecessors, at 15 fps."""

S2UE_FRAME_RATE: Final = 15.0


@dataclass(frozen=True, kw_only=True)
class PointSettings:
    """The choices that define an error of points.

    Attributes
    ----------
    metric : Metric
        The metric's name and unit.
    points : str
        The points in words.
    order : int
        Order of the derivative compared: 0 for positions, 2 for accelerations.
    too_short : str
        Why a clip with too few frames has no error.
    """

    metric: Metric
    points: str
    order: int = 0
    too_short: str = "the clip has no frame after those that seed the generator"

    def description(self, frame_rate: float, scale: float) -> dict[str, str]:
        """Return the settings in words, for a footnote."""
        known = math.isfinite(scale)
        return {
            "points": self.points,
            "scale": f"{scale:.4g}, the same for all clips" if known else "none: no points",
            "frame rate": f"{frame_rate:g} fps",
            "left out": f"the first {SEED_FRAMES} frames",
        }


def _mean_absolute(name: str, points: str) -> PointSettings:
    metric = Metric(f"mean absolute error ({name}, s2ue)", "mm", "lower")
    return PointSettings(metric=metric, points=points)


def _acceleration(name: str, points: str) -> PointSettings:
    return PointSettings(
        metric=Metric(f"mean acceleration error ({name}, s2ue)", "mm/s²", "lower"),
        points=points,
        order=2,
        too_short="the clip has fewer than 3 frames after those that seed the generator",
    )


_JOINTS: Final = "joints of the default body"
_LANDMARKS: Final = "face landmarks"
MAJE: Final = _mean_absolute("MAJE", _JOINTS)
MALE: Final = _mean_absolute("MALE", _LANDMARKS)
MACE_POSES: Final = _acceleration("MAcE-P", _JOINTS)
MACE_LANDMARKS: Final = _acceleration("MAcE-LM", _LANDMARKS)


def paired(generated: Floats, recorded: Floats) -> tuple[Floats, Floats, str]:
    """Return two clips cut to the shorter one's length, and why they cannot be paired, if so.

    Parameters
    ----------
    generated, recorded : ndarray, shape (T, ...), (U, ...)
        Motion at one frame rate, in one representation.

    Returns
    -------
    generated, recorded : ndarray
        The clips with the same number of frames.
    reason : str
        Empty if they can be paired.
    """
    lengths = len(generated), len(recorded)
    frames = min(lengths)
    reason = ""
    if frames < LEAST_OVERLAP * max(lengths):
        reason = f"the clip has {lengths[0]} frames and the recording {lengths[1]}"
    return generated[:frames], recorded[:frames], reason


def box_scale(clips: Iterable[Floats]) -> float:
    """Return the factor that scales all points of all clips into a box with a diagonal of 1 m.

    Parameters
    ----------
    clips : iterable of ndarray, shape (..., 3)
        Points in metres.

    Returns
    -------
    float
        NaN if there is no clip, or all points coincide.
    """
    corners = [
        corner
        for points in (clip.reshape(-1, 3) for clip in clips)
        for corner in (points.min(axis=0), points.max(axis=0))
    ]
    diagonal = float(np.linalg.norm(np.ptp(corners, axis=0))) if corners else 0.0
    return 1 / diagonal if diagonal else math.nan


def point_error(
    generated: Floats,
    recorded: Floats,
    *,
    frame_rate: float,
    settings: PointSettings,
    scale: float = 1.0,
) -> MetricResult:
    """Return the mean absolute difference of coordinates, or of their accelerations.

    Parameters
    ----------
    generated, recorded : ndarray, shape (T, P, 3)
        Points in metres.
    frame_rate : float
        Frames per second of both.
    settings : PointSettings
        `MAJE`, `MALE`, `MACE_POSES` or `MACE_LANDMARKS`.
    scale : float
        Factor that all points are multiplied by; see `box_scale`.

    Returns
    -------
    MetricResult
        In mm, or in mm/s² (second differences times the frame rate squared); 0 for the recording
        itself. NaN if the clips cannot be paired or too few frames are left.
    """
    description = settings.description(frame_rate, scale)
    generated, recorded, reason = paired(generated, recorded)
    difference = np.diff((generated - recorded)[SEED_FRAMES:], n=settings.order, axis=0)
    if reason or not difference.size:
        return settings.metric.missing(reason or settings.too_short, description)
    value = 1000 * scale * frame_rate**settings.order * float(np.abs(difference).mean())
    return settings.metric.score(value, difference.shape[0] * difference.shape[1], description)


def velocity_error(
    generated: Floats,
    recorded: Floats,
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
        Settings of the positions.

    Returns
    -------
    MetricResult
        In m/s; 0 for the recording itself. NaN if the clips cannot be paired, and for one frame.
    """
    metric = Metric(f"velocity error ({norm})", "m/s", "lower")
    averaged = "components" if norm == "L1" else "vectors"
    description = dict(settings or {}) | {
        "frame rate": f"{frame_rate:g} fps",
        "mean over": f"frames, joints and {averaged}",
    }
    generated, recorded, reason = paired(generated, recorded)
    if reason or len(generated) < 2:
        return metric.missing(reason or "a velocity needs two frames", description)
    difference = np.diff(generated - recorded, axis=0) * frame_rate
    size = np.abs(difference) if norm == "L1" else np.linalg.norm(difference, axis=2)
    return metric.score(float(size.mean()), difference.shape[0] * difference.shape[1], description)
