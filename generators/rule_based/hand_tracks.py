"""The course of one hand through its planned gestures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.rule_based.emotion_style import GestureManner
from generators.rule_based.gesture_plan import Gesture, endings
from generators.rule_based.hand_pose import (
    CURLS,
    ELBOW_OUT,
    FLEXION,
    PLACE,
    PRONATION,
    SPREAD,
    within_joint_range,
)
from generators.rule_based.minimum_jerk import Movement, follow
from generators.rule_based.resting import Rest
from generators.rule_based.smooth_noise import smooth_noise

FloatArray = NDArray[np.float64]

_CENTRE: Final = np.array([-0.10, -0.48, 0.52])
_PLACE_VARIETY: Final = np.array([0.05, 0.045, 0.04])
_TURN_VARIETY: Final = 7.0
_SECOND_HAND: Final = 0.9
_BOTH_APART: Final = (0.09, 0.0, 0.0)
_FOLLOW_THROUGH: Final = 0.05
_SETTLING: Final = 1.2
_HAND_DRIFT: Final = 0.011
_OVERLAP: Final = 0.2
_REBOUND: Final = 0.14
_REBOUND_SECONDS: Final = 0.35
_SHORTEST_REBOUND: Final = 0.2


def hand_track(
    hand: str,
    gestures: Sequence[Gesture],
    rests: Sequence[Rest],
    manner: GestureManner,
    times: FloatArray,
    restlessness: float,
    rng: np.random.Generator,
) -> FloatArray:
    """Return what `hand` does at each time.

    Parameters
    ----------
    hand : str
        ``left`` or ``right``.
    gestures : sequence of Gesture
        The plan for both hands.
    rests : sequence of Rest
        How both rest, should they.
    manner : GestureManner
    times : ndarray, shape (T,)
        Seconds.
    restlessness : float
        Speed of the idle drift against an unmoved speaker's.
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (T, 13)
        The channels of `hand_pose`.
    """
    habit = _variety(rng) * 0.5
    habit[ELBOW_OUT] += manner.elbows_out
    poses = [
        (rest.begin, rest.poses[hand].channels() + habit + _variety(rng) * 0.1) for rest in rests
    ]
    own = [gesture for gesture in gestures if hand in gesture.hands]
    start = poses[0][1]
    movements = _settling(poses, 0.0, own[0].begin if own else np.inf, manner.tempo)
    following = [*(gesture.begin for gesture in own[1:]), np.inf]
    for gesture, ending, free_until in zip(
        own, endings(own, manner.tempo), following, strict=False
    ):
        size = manner.amplitude * (0.75 + 0.35 * gesture.strength) * rng.uniform(0.9, 1.1)
        if len(gesture.hands) == 2 and hand == "left":
            size *= _SECOND_HAND
        apex, upbeat = _key_poses(gesture, manner, size, rng)
        bow = np.zeros(len(start))
        bow[PLACE] = (0.05 * size, 0.0, 0.03 * size)
        movements += [
            Movement(
                start=gesture.begin,
                end=gesture.stroke + _OVERLAP * (gesture.apex - gesture.stroke),
                target=upbeat,
                bow=bow,
            ),
            Movement(start=gesture.stroke, end=gesture.apex, target=apex),
        ]
        if ending.release - gesture.apex > _SHORTEST_REBOUND:
            end = min(gesture.apex + _REBOUND_SECONDS / manner.tempo, ending.release)
            settled = apex + _REBOUND * (upbeat - apex)
            movements.append(Movement(start=gesture.apex, end=end, target=settled))
        if ending.rest is not None:
            rest = next(pose for begin, pose in reversed(poses) if begin <= ending.release)
            movements.append(
                Movement(start=ending.release, end=ending.rest, target=rest, bow=bow * 0.6)
            )
            movements += _settling(poses, ending.rest, free_until, manner.tempo)
    course = follow(start, movements, times)
    # Fingers and the wrist's bend trail the arm a little, as loosely held hands do.
    trailing = follow(start, movements, times - _FOLLOW_THROUGH)
    for channels in (CURLS, SPREAD, FLEXION):
        course[:, channels] = trailing[:, channels]
    return within_joint_range(course + _drift(times, len(start), restlessness, rng))


def _settling(
    poses: Sequence[tuple[float, FloatArray]], free: float, until: float, tempo: float
) -> list[Movement]:
    """Return the changes of pose of a hand that rests from `free` until its next gesture."""
    lasts = _SETTLING / tempo
    return [
        Movement(start=begin, end=begin + lasts, target=pose)
        for begin, pose in poses
        if begin > free and begin + lasts < until
    ]


def _key_poses(
    gesture: Gesture, manner: GestureManner, size: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Return the hand at the end and at the beginning of the gesture's stroke."""
    apex = gesture.form.apex.channels()
    apex[PLACE] = _CENTRE + (apex[PLACE] - _CENTRE) * (0.4 + 0.6 * size)
    apex[ELBOW_OUT] += manner.elbows_out
    apex += _variety(rng)
    if len(gesture.hands) == 2:
        apex[PLACE] += _BOTH_APART
    upbeat = apex.copy()
    upbeat[PLACE] -= size * np.array(gesture.form.stroke)
    upbeat[[PRONATION, FLEXION]] += np.array(gesture.form.wind_up) * min(size, 1.2)
    shape = gesture.form.wind_up_shape
    upbeat[CURLS] = (shape.thumb, shape.index, shape.middle, shape.ring, shape.pinky)
    upbeat[SPREAD] = shape.spread
    return apex, upbeat


def _variety(rng: np.random.Generator) -> FloatArray:
    """Return small differences, shape (13,), for no two gestures are quite the same."""
    variety = np.zeros(13)
    variety[PLACE] = rng.normal(0, _PLACE_VARIETY)
    variety[[ELBOW_OUT, PRONATION, FLEXION]] = rng.normal(0, _TURN_VARIETY, 3) * (0.6, 1.0, 0.5)
    variety[CURLS] = rng.normal(0, 0.06) + rng.normal(0, 0.05, 5)
    return variety


def _drift(
    times: FloatArray, channels: int, restlessness: float, rng: np.random.Generator
) -> FloatArray:
    noise = smooth_noise(times, channels, 0.08 * restlessness, 0.8 * restlessness, rng)
    scale = np.zeros(channels)
    scale[PLACE] = _HAND_DRIFT
    scale[[ELBOW_OUT, PRONATION, FLEXION]] = (1.2, 2.0, 1.2)
    scale[CURLS] = 0.07
    return noise * scale
