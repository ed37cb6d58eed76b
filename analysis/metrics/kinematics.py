"""Kinematics: joints on the default body, their jerk, acceleration and foot sliding.

Jerk and acceleration are large where motion trembles or jumps.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.signal import butter, sosfiltfilt

from analysis.metrics.scores import Metric, MetricResult
from motion.arrays import Floats, Floats32
from motion.clip import MotionClip
from motion.placement import stand_on_ground
from motion.resample import resample
from motion.skeleton import (
    JOINT_COUNT,
    LEFT_HAND_JOINTS,
    REST_JOINTS,
    RIGHT_HAND_JOINTS,
    forward_kinematics,
    joint_index,
)

HIGHEST_FRAME_RATE: Final = 30.0
"""Metrics use at most 30 frames per second, whatever the clips' rate."""

ARM_JOINTS: Final = (
    "left_wrist",
    "left_elbow",
    "left_shoulder",
    "right_wrist",
    "right_elbow",
    "right_shoulder",
)
"""The six joints of AMUSE's beat alignment (Chhatre et al. 2024, appendix E)."""

WRISTS: Final = ("left_wrist", "right_wrist")

UPPER_BODY_JOINTS: Final = ("neck", "head", *ARM_JOINTS)

GESTURE_JOINTS: Final = (
    "spine1",
    "spine2",
    "spine3",
    "neck",
    "head",
    *(
        f"{side}_{joint}"
        for side in ("left", "right")
        for joint in ("collar", "shoulder", "elbow", "wrist")
    ),
    *LEFT_HAND_JOINTS,
    *RIGHT_HAND_JOINTS,
)
"""Joints whose rotations make a gesture: everything above the pelvis except the face."""


def common_frame_rate(frame_rates: Collection[float]) -> float:
    """Return the rate at which clips of different rates are compared: the slowest, at most 30.

    Any faster rate would need interpolated frames, which are smooth by construction and lower jerk.
    """
    return min(HIGHEST_FRAME_RATE, *frame_rates)


def select(positions: Floats, joints: Sequence[str]) -> Floats:
    """Return the positions of the named joints, shape (T, len(joints), 3)."""
    return positions[:, [joint_index(name) for name in joints]]


@dataclass(frozen=True, kw_only=True, eq=False)
class JointMotion:
    """The joint positions of one clip.

    Attributes
    ----------
    relative : ndarray, shape (T, 55, 3), float64
        Positions relative to the pelvis in metres, y up.
    pelvis : ndarray, shape (T, 3), float64
        Pelvis positions in the world, in metres, with the feet on the ground as in videos. All
        values are rounded to single precision, whether computed or read.
    """

    relative: Floats
    pelvis: Floats

    @classmethod
    def of(cls, packed: Floats32) -> JointMotion:
        """Return the motion that `packed_joints` packed."""
        values = packed.astype(np.float64)
        return cls(relative=values[:, :JOINT_COUNT], pelvis=values[:, JOINT_COUNT])


def joint_motion(clip: MotionClip, frame_rate: float) -> JointMotion:
    """Return the positions of all joints on the default body, whatever the clip's own shape.

    Parameters
    ----------
    clip : MotionClip
        A clip at any frame rate.
    frame_rate : float
        Frames per second of the result.
    """
    return JointMotion.of(packed_joints(clip, frame_rate))


def packed_joints(clip: MotionClip, frame_rate: float) -> Floats32:
    """Return a `joint_motion` as one array, shape (T, 56, 3): the pelvis comes last."""
    grounded = stand_on_ground(resample(clip, frame_rate), REST_JOINTS)
    relative = forward_kinematics(grounded.poses, np.zeros_like(grounded.trans), REST_JOINTS)[0]
    relative -= relative[:, :1]
    pelvis = REST_JOINTS[0] + grounded.trans
    return np.concatenate([relative, pelvis[:, None]], axis=1).astype(np.float32)


_FILTER_ORDER: Final = 4

FEET: Final = ("left_foot", "right_foot")

CONTACT_HEIGHT: Final = 0.025
"""Metres above the ground below which a foot may be in contact with it."""

_GROUND: Final = 0.02
"""The ground is at this quantile of the feet's heights, so that a few damaged frames do not move
it."""


@dataclass(frozen=True, kw_only=True)
class DerivativeSettings:
    """The choices that define a jerk or an acceleration, besides the frame rate.

    Attributes
    ----------
    name, unit : str
        Name and unit of the metric.
    order : int
        2 for acceleration, 3 for jerk.
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
"""Wrists without a filter; jitter counts in full, and so does recording noise."""

GENEA: Final = DerivativeSettings(name="jerk (genea)", joints=UPPER_BODY_JOINTS)
"""GENEA's evaluation, without a filter; its "all joints" are here those of head and arms."""

GENEA_ACCELERATION: Final = DerivativeSettings(
    name="acceleration (genea)", unit="m/s²", order=2, joints=UPPER_BODY_JOINTS, fewest=3
)


def mean_derivative(
    positions: Floats, *, frame_rate: float, settings: DerivativeSettings
) -> MetricResult:
    """Return the mean magnitude of a derivative of position over frames and joints.

    Parameters
    ----------
    positions : ndarray, shape (T, J, 3)
        Positions of `settings.joints` in metres.
    frame_rate : float
        Frames per second.
    settings : DerivativeSettings
        The derivative, the joints and the filter.

    Returns
    -------
    MetricResult
        In m/s² or m/s³: mean norm of second or third differences times that power of the frame
        rate, as in GENEA's evaluation (Kucherenko et al. 2021). NaN for a clip of too few frames,
        or if the cut-off is not below half the frame rate.
    """
    metric = Metric(settings.name, settings.unit, "near the reference")
    cutoff, order = settings.cutoff, settings.order
    description = {
        "joints": ", ".join(settings.joints),
        "frame rate": f"{frame_rate:g} fps",
        "filter": "none"
        if cutoff is None
        else f"Butterworth low-pass, order {_FILTER_ORDER}, {cutoff:g} Hz, zero phase",
        "positions": "relative to the pelvis, default body, metres",
    }
    if len(positions) < settings.fewest:
        return metric.missing(f"the clip has fewer than {settings.fewest} frames", description)
    if cutoff is not None:
        if cutoff >= frame_rate / 2:
            reason = f"{frame_rate:g} fps is too slow for a {cutoff:g} Hz filter"
            return metric.missing(reason, description)
        sections = butter(_FILTER_ORDER, cutoff, fs=frame_rate, output="sos")
        positions = sosfiltfilt(sections, positions, axis=0)
    sizes = np.linalg.norm(np.diff(positions, n=order, axis=0), axis=2) * frame_rate**order
    return metric.score(float(sizes.mean()), sizes.size, description)


def foot_sliding(positions: Floats, *, frame_rate: float) -> MetricResult:
    """Return the mean sliding speed of the feet over frames in which they are on the ground.

    Parameters
    ----------
    positions : ndarray, shape (T, 2, 3)
        Positions of the joints `FEET` in the world, in metres, y up.
    frame_rate : float
        Frames per second.

    Returns
    -------
    MetricResult
        In m/s: horizontal speed between two frames times ``2 - 2 ** (h / H)`` of the greater height
        h above the clip's own ground, over frame pairs with h below H = `CONTACT_HEIGHT`. NaN for
        one frame, or if no foot stays on the ground from one frame to the next.
    """
    description = {
        "joints": ", ".join(FEET),
        "frame rate": f"{frame_rate:g} fps",
        "ground": f"percentile {100 * _GROUND:g} of the heights of the clip's feet",
        "contact": f"within {100 * CONTACT_HEIGHT:g} cm above the ground, weighted 2 - 2^(h/H)",
        "positions": "in the world, default body, metres",
    }
    metric = Metric("foot sliding", "m/s", "lower")
    if len(positions) < 2:
        return metric.missing("a speed needs two frames", description)
    heights = positions[..., 1] - np.quantile(positions[..., 1], _GROUND)
    height = np.maximum(0, np.maximum(heights[1:], heights[:-1]))
    speed = np.linalg.norm(np.diff(positions[..., [0, 2]], axis=0), axis=2) * frame_rate
    standing = height < CONTACT_HEIGHT
    if not standing.any():
        reason = "no foot stays on the ground from one frame to the next"
        return metric.missing(reason, description)
    weight = 2 - 2 ** (height[standing] / CONTACT_HEIGHT)
    return metric.score(float((speed[standing] * weight).mean()), int(standing.sum()), description)
