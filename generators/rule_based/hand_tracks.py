"""The course of one hand through its planned gestures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.rule_based.emotion_style import GestureManner
from generators.rule_based.gesture_plan import Gesture, endings
from generators.rule_based.hand_pose import (
    CHANNELS,
    CURLS,
    ELBOW_OUT,
    FLEXION,
    PLACE,
    POSES,
    PRONATION,
    SPREAD,
    clip_to_joint_range,
)
from generators.rule_based.resting import SETTLING, Idling, Rest
from generators.rule_based.time_courses import Movement, follow

FloatArray = NDArray[np.float64]

_GESTURE_CENTRE: Final = np.array([-0.10, -0.48, 0.52])
_PLACE_VARIETY: Final = np.array([0.05, 0.045, 0.04])
_TURN_VARIETY: Final = 7.0
_SECOND_HAND: Final = 0.9
_BOTH_APART: Final = (0.09, 0.0, 0.0)
_FOLLOW_THROUGH: Final = 0.05
_OVERLAP: Final = 0.2
_REBOUND: Final = 0.14
_REBOUND_SECONDS: Final = 0.35
_SHORTEST_REBOUND: Final = 0.2
_ALONE: Final = CHANNELS
_RESTING: Final = CHANNELS + 1
_IS_ON_TOP: Final = CHANNELS + 2
_DETOUR: Final = (0.0, 0.0, 0.5)


def hand_track(
    hand: str,
    gestures: Sequence[Gesture],
    rests: Sequence[Rest],
    manner: GestureManner,
    times: FloatArray,
    idling: Idling,
    rng: np.random.Generator,
) -> FloatArray:
    """Return the pose of `hand` at each time.

    Parameters
    ----------
    hand : str
        ``left`` or ``right``.
    gestures : sequence of Gesture
        The plan for both hands.
    rests : sequence of Rest
        The resting poses of both.
    manner : GestureManner
    times : ndarray, shape (T,)
        Seconds.
    idling : Idling
        The idle motion of both.
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (T, 13)
        The channels of `hand_pose`.
    """
    habit = _variety(rng) * 0.5
    habit[ELBOW_OUT] += manner.elbows_out
    poses = [(rest.begin, _rest_pose(rest, hand, habit + _variety(rng) * 0.1)) for rest in rests]
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
            movements += _settling(poses, ending.release, free_until, manner.tempo)
    course = follow(start, movements, times)
    # Fingers and the wrist's bend trail the arm a little, as loosely held hands do.
    trailing = follow(start, movements, times - _FOLLOW_THROUGH)
    for channels in (CURLS, SPREAD, FLEXION):
        course[:, channels] = trailing[:, channels]
    # A hand goes round the one that it comes to lie on.
    on_top = course[:, _IS_ON_TOP, None]
    course[:, PLACE] += on_top * (1 - on_top) * _DETOUR
    return clip_to_joint_range(
        idling.add_to(
            hand, course[:, :CHANNELS], alone=course[:, _ALONE], resting=course[:, _RESTING]
        )
    )


def _rest_pose(rest: Rest, hand: str, personal: FloatArray) -> FloatArray:
    """Return the channels of a rest pose, and whether the hand is alone, rests and is on top."""
    pose = rest.poses[hand]
    if rest.clasped:  # Such hands fit in one way only.
        return np.array([*pose.channels(), 0.0, 1.0, float(pose is POSES["clasped_over"])])
    return np.array([*(pose.channels() + personal), 1.0, 1.0, 0.0])


def _settling(
    poses: Sequence[tuple[float, FloatArray]], free: float, next_gesture: float, tempo: float
) -> list[Movement]:
    """Return the changes of pose of a hand that is `free` until its next gesture."""
    duration = SETTLING / tempo
    return [
        Movement(start=begin, end=begin + duration, target=pose)
        for begin, pose in poses
        if begin > free and begin + duration < next_gesture
    ]


def _key_poses(
    gesture: Gesture, manner: GestureManner, size: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Return the hand at the end and at the beginning of the gesture's stroke."""
    apex = gesture.form.apex.channels()
    apex[PLACE] = _GESTURE_CENTRE + (apex[PLACE] - _GESTURE_CENTRE) * (0.4 + 0.6 * size)
    apex[ELBOW_OUT] += manner.elbows_out
    apex[CURLS.start :] = gesture.form.fingers(rng)
    apex += _variety(rng)
    if len(gesture.hands) == 2:
        apex[PLACE] += _BOTH_APART
    upbeat = apex.copy()
    upbeat[PLACE] -= size * np.array(gesture.form.stroke)
    upbeat[[PRONATION, FLEXION]] += np.array(gesture.form.wind_up) * min(size, 1.2)
    shape = gesture.form.wind_up_shape
    upbeat[CURLS] = (shape.thumb, shape.index, shape.middle, shape.ring, shape.pinky)
    upbeat[SPREAD] = shape.spread
    return np.array([*apex, 1.0, 0.0, 0.0]), np.array([*upbeat, 1.0, 0.0, 0.0])


def _variety(rng: np.random.Generator) -> FloatArray:
    """Return small differences, shape (13,), for no two gestures are quite the same."""
    variety = np.zeros(13)
    variety[PLACE] = rng.normal(0, _PLACE_VARIETY)
    variety[[ELBOW_OUT, PRONATION, FLEXION]] = rng.normal(0, _TURN_VARIETY, 3) * (0.6, 1.0, 0.5)
    variety[CURLS] = rng.normal(0, 0.06) + rng.normal(0, 0.05, 5)
    return variety
