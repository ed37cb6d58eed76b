"""The curves of a motion that the corpus' speech decides, and how well one motion follows another.

They can be computed from any motion in BEAT's format, so that a network's motion can be compared
with the process.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from training.spaces.beat import BEAT_SKELETON, FACIAL_WEIGHTS, UPPER_BODY_JOINTS, upper_body_motion

FloatArray = NDArray[np.float64]

_CENTIMETRES: Final = 100.0
_BROWS: Final = ("InnerUp", "OuterUpLeft", "OuterUpRight")


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionCurves:
    """Five curves of a motion, each of shape (T,).

    Attributes
    ----------
    wrist_speed : ndarray
        Metres per second, mean of both wrists.
    hand_height : ndarray
        Metres of the wrists above the hips, mean of both.
    head_down : ndarray
        Degrees by which the chin is lowered towards the trunk.
    jaw_open, brows_up : ndarray
        Weights in [0, 1]: the jaw's, and the mean of the brows'.
    """

    wrist_speed: FloatArray
    hand_height: FloatArray
    head_down: FloatArray
    jaw_open: FloatArray
    brows_up: FloatArray


@dataclass(frozen=True, kw_only=True)
class CurveCorrelation:
    """Correlation of one motion's curve with another's.

    Attributes
    ----------
    curve : str
        A field of `MotionCurves`.
    correlation : float
        Pearson's, over frames; NaN where there is none.
    reason : str
        Why there is none, or empty.
    """

    curve: str
    correlation: float
    reason: str = ""


def curves_of(body: FloatArray, face: FloatArray, frame_rate: float) -> MotionCurves:
    """Return the curves of a motion.

    Parameters
    ----------
    body : ndarray, shape (T, 141)
        Axis-angle in radians of BEAT's 47 joints.
    face : ndarray, shape (T, 51)
        ARKit weights.
    frame_rate : float
        Frames per second of both.
    """
    wrists = wrist_positions(body)
    neck = body.reshape(len(body), len(UPPER_BODY_JOINTS), 3)[:, 1:3]
    lower, upper = (Rotation.from_rotvec(neck[:, joint]) for joint in (0, 1))
    forward = (lower * upper).apply([0, 0, 1])
    brows = [FACIAL_WEIGHTS.index(f"brow{name}") for name in _BROWS]
    return MotionCurves(
        wrist_speed=mean_speed(wrists, frame_rate),
        hand_height=wrists[:, :, 1].mean(axis=1),
        head_down=-np.degrees(np.arcsin(np.clip(forward[:, 1], -1, 1))),
        jaw_open=face[:, FACIAL_WEIGHTS.index("jawOpen")],
        brows_up=face[:, brows].mean(axis=1),
    )


def wrist_positions(body: FloatArray) -> FloatArray:
    """Return positions of the right and the left wrist, (T, 2, 3) in metres above the hips.

    The figure is the idealised one, whose hips stand still at the origin.
    """
    motion = upper_body_motion(body, 1.0, BEAT_SKELETON)
    positions, _ = motion.forward_kinematics()
    wrists = [motion.joint_names.index(f"{side}Hand") for side in ("Right", "Left")]
    return positions[:, wrists] / _CENTIMETRES


def correlate_motions(
    motion: MotionCurves, reference: MotionCurves
) -> tuple[CurveCorrelation, ...]:
    """Return the correlation of each curve of two motions, over the frames both have."""
    return tuple(
        correlate_curves(field.name, getattr(motion, field.name), getattr(reference, field.name))
        for field in fields(MotionCurves)
    )


def correlate_curves(curve: str, motion: FloatArray, reference: FloatArray) -> CurveCorrelation:
    """Return the correlation of two curves (T,), over the frames both have."""
    frames = min(len(motion), len(reference))
    if frames < 3:
        reason = f"{frames} frames are too few"
        return CurveCorrelation(curve=curve, correlation=float("nan"), reason=reason)
    motion, reference = motion[:frames], reference[:frames]
    for values, owner in ((motion, "the motion's"), (reference, "the wanted")):
        if not np.isfinite(values).all():
            reason = f"{owner} curve is not finite"
            return CurveCorrelation(curve=curve, correlation=float("nan"), reason=reason)
        if np.ptp(values) < 1e-9:
            reason = f"{owner} curve does not change"
            return CurveCorrelation(curve=curve, correlation=float("nan"), reason=reason)
    return CurveCorrelation(curve=curve, correlation=float(np.corrcoef(motion, reference)[0, 1]))


def mean_speed(positions: FloatArray, frame_rate: float) -> FloatArray:
    """Return the mean speed (T,) of points (T, N, 3); 0 for a single frame."""
    if len(positions) < 2:
        return np.zeros(len(positions))
    velocity = np.gradient(positions, axis=0) * frame_rate
    return np.asarray(np.linalg.norm(velocity, axis=2).mean(axis=1))
