"""The courses of both hands: through the planned gestures, and at rest between them.

Hands rest in changing poses, and are never quite still.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass
from typing import Final

import numpy as np

from generators.rule_based.gesture_plan import HANDS, Gesture, endings, plan_gestures
from generators.rule_based.time_courses import Movement, follow, on_accents, smooth_noise
from generators.rule_based.vocabulary import POSES, Channel, EmotionStyle, GestureManner, HandPose
from motion.arrays import Floats
from motion.prosody import Prosody

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
_DETOUR: Final = (0.0, 0.0, 0.5)

_ALONE: Final = Channel.COUNT
_RESTING: Final = Channel.COUNT + 1
_IS_ON_TOP: Final = Channel.COUNT + 2
"""Further channels of a course, from 0 to 1: whether the hand moves independently of the other,
whether it rests, and whether it lies on top of the other."""

_JOINT_LIMITS: Final = (
    (Channel.PRONATION, 80.0),
    (Channel.FLEXION, 70.0),
    (Channel.DEVIATION, 20.0),
)
"""Limits of forearm and wrist in either direction, in degrees."""


def move_hands(
    style: EmotionStyle, prosody: Prosody, times: Floats, rng: np.random.Generator
) -> dict[str, Floats]:
    """Return the pose of each hand at each time.

    Parameters
    ----------
    style : EmotionStyle
    prosody : Prosody
        Prosody of the speech, on whose accents the hands gesture.
    times : ndarray, shape (T,)
        Seconds, one for each frame of `prosody`.
    rng : numpy.random.Generator

    Returns
    -------
    dict of str to ndarray, shape (T, 13)
        The channels of `vocabulary.HandPose`, by hand.
    """
    manner = style.gestures
    gestures = plan_gestures(prosody, manner, rng)
    rests = plan_rests(manner, gestures, len(times) / prosody.frame_rate, rng)
    beats = on_accents(prosody, times, rise=0.2, fall=0.35) * manner.amplitude
    own, together = _drifts(times, style.liveliness.restlessness, rng)
    tracks = {}
    for hand in HANDS:
        course = _course(hand, gestures, rests, manner, times, rng)
        tracks[hand] = _within_joint_limits(_with_idling(course, own[hand], together[hand], beats))
    return tracks


def _course(
    hand: str,
    gestures: Sequence[Gesture],
    rests: Sequence[Rest],
    manner: GestureManner,
    times: Floats,
    rng: np.random.Generator,
) -> Floats:
    """Return the planned course of `hand`, shape (T, 16)."""
    habit = _variety(rng) * 0.5
    habit[Channel.ELBOW_OUT] += manner.elbows_out
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
        bow[Channel.PLACE] = (0.05 * size, 0.0, 0.03 * size)
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
    # Fingers and the wrist's bend trail the arm slightly, as in relaxed hands.
    trailing = follow(start, movements, times - _FOLLOW_THROUGH)
    for channels in (Channel.CURLS, Channel.SPREAD, Channel.FLEXION):
        course[:, channels] = trailing[:, channels]
    # A hand goes around the other before it lies on top of it.
    on_top = course[:, _IS_ON_TOP, None]
    course[:, Channel.PLACE] += on_top * (1 - on_top) * _DETOUR
    return course


def _rest_pose(rest: Rest, hand: str, personal: Floats) -> Floats:
    """Return the channels of a rest pose, including the three further ones."""
    pose = rest.poses[hand]
    if rest.clasped:  # Clasped hands fit together in one way only.
        return np.array([*pose.channels(), 0.0, 1.0, float(pose is POSES["clasped_over"])])
    return np.array([*(pose.channels() + personal), 1.0, 1.0, 0.0])


def _settling(
    poses: Sequence[tuple[float, Floats]], free: float, next_gesture: float, tempo: float
) -> list[Movement]:
    """Return the changes of pose of a hand that is `free` until its next gesture."""
    duration = _SETTLING / tempo
    return [
        Movement(start=begin, end=begin + duration, target=pose)
        for begin, pose in poses
        if begin > free and begin + duration < next_gesture
    ]


def _key_poses(
    gesture: Gesture, manner: GestureManner, size: float, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Return the hand at the end and at the start of the gesture's stroke."""
    apex = gesture.form.apex.channels()
    apex[Channel.PLACE] = _GESTURE_CENTRE + (apex[Channel.PLACE] - _GESTURE_CENTRE) * (
        0.4 + 0.6 * size
    )
    apex[Channel.ELBOW_OUT] += manner.elbows_out
    apex[Channel.CURLS.start :] = gesture.form.fingers(rng)
    apex += _variety(rng)
    if len(gesture.hands) == 2:
        apex[Channel.PLACE] += _BOTH_APART
    upbeat = apex.copy()
    upbeat[Channel.PLACE] -= size * np.array(gesture.form.stroke)
    upbeat[[Channel.PRONATION, Channel.FLEXION]] += np.array(gesture.form.wind_up) * min(size, 1.2)
    upbeat[Channel.CURLS.start :] = astuple(gesture.form.wind_up_shape)
    return np.array([*apex, 1.0, 0.0, 0.0]), np.array([*upbeat, 1.0, 0.0, 0.0])


def _variety(rng: np.random.Generator) -> Floats:
    """Return small random differences, shape (13,), between gestures."""
    variety = np.zeros(Channel.COUNT)
    variety[Channel.PLACE] = rng.normal(0, _PLACE_VARIETY)
    variety[[Channel.ELBOW_OUT, Channel.PRONATION, Channel.FLEXION]] = rng.normal(
        0, _TURN_VARIETY, 3
    ) * (0.6, 1.0, 0.5)
    variety[Channel.CURLS] = rng.normal(0, 0.06) + rng.normal(0, 0.05, 5)
    return variety


def _within_joint_limits(course: Floats) -> Floats:
    for channel, limit in _JOINT_LIMITS:
        course[:, channel] = np.clip(course[:, channel], -limit, limit)
    course[:, Channel.CURLS] = np.clip(course[:, Channel.CURLS], 0, 1)
    course[:, Channel.SPREAD] = np.clip(course[:, Channel.SPREAD], -0.6, 1)
    return course


_SETTLING: Final = 1.2
"""Seconds that a neutral speaker takes from one rest pose to the next."""

_REST_SECONDS: Final = (1.8, 4.0)
"""Shortest and longest duration of a rest pose, in seconds."""

_KEEPS_REST_POSE: Final = 0.3
"""Probability that both hands keep the emotion's own rest pose."""

_CLASPED: Final = ("clasped_over", "clasped_under")
_AT_THE_SIDES: Final = ("held_off", "held_off")
_ONE_HANGS: Final = ("before_the_waist", "held_off")

_ALTERNATIVES: Final[Mapping[HandPose, Sequence[tuple[str, str]]]] = {
    POSES["before_the_waist"]: (_CLASPED, _AT_THE_SIDES, _ONE_HANGS),
    POSES["held_off"]: (_CLASPED, _AT_THE_SIDES, _ONE_HANGS),
    POSES["hanging_slack"]: (_CLASPED,),
}
"""Alternatives to an emotion's rest pose, for the hand that gestures next and for the other."""


@dataclass(frozen=True, kw_only=True)
class Rest:
    """The rest pose of each hand from `begin` on, in seconds."""

    begin: float
    poses: Mapping[str, HandPose]

    @property
    def clasped(self) -> bool:
        """Whether the hands are clasped, so that they only move together."""
        return POSES["clasped_over"] in self.poses.values()


def plan_rests(
    manner: GestureManner, gestures: Sequence[Gesture], seconds: float, rng: np.random.Generator
) -> tuple[Rest, ...]:
    """Return the rest poses of a clip of so many seconds in time order, the first from 0 on.

    Clenched and drawn-up hands stay as they are; others are clasped, hang, or one of them hangs.
    They change only when both are free for long enough, so that they do not meet on the way.
    """
    rest_poses = dict.fromkeys(HANDS, manner.rest)
    rests: list[Rest] = []
    for start, end, leaving in _free_intervals(manner, gestures, seconds):
        begin = start
        while not rests or end - begin > _SETTLING / manner.tempo:
            rests.append(Rest(begin=begin, poses=_poses(rest_poses, str(rng.choice(leaving)), rng)))
            begin += rng.uniform(*_REST_SECONDS)
        if rests[-1].clasped:
            rests.append(Rest(begin=end, poses=rest_poses))
    return tuple(rests)


def _free_intervals(
    manner: GestureManner, gestures: Sequence[Gesture], seconds: float
) -> Iterator[tuple[float, float, Sequence[str]]]:
    """Yield start and end of each interval without gestures, and the hands that gesture next."""
    released = 0.0
    release_times = {
        (gesture.begin, hand): ending.release
        for hand in HANDS
        for hand_gestures in [[gesture for gesture in gestures if hand in gesture.hands]]
        for gesture, ending in zip(hand_gestures, endings(hand_gestures, manner.tempo), strict=True)
    }
    for gesture in gestures:
        yield released, gesture.begin, gesture.hands
        released = max(released, *(release_times[gesture.begin, hand] for hand in gesture.hands))
    yield released, seconds, HANDS


def _poses(
    rest_poses: Mapping[str, HandPose], leaving: str, rng: np.random.Generator
) -> Mapping[str, HandPose]:
    """Return the rest pose of both hands; the hand that gestures next is on top."""
    alternatives = _ALTERNATIVES.get(rest_poses[leaving], ())
    if not alternatives or rng.random() < _KEEPS_REST_POSE:
        return rest_poses
    leading_pose, other_pose = alternatives[int(rng.integers(len(alternatives)))]
    return {hand: POSES[leading_pose if hand == leaving else other_pose] for hand in HANDS}


# Place; elbow, pronation, flexion, deviation; curls; spread.
_DRIFT: Final = np.array([*3 * [0.015], 1.5, 3.0, 2.5, 0.0, *5 * [0.07], 0.0])
_BEAT: Final = np.array([0.0, -0.02, 0.04, 0.0, 0.0, -6.0, 0.0, *5 * [-0.07], 0.0])
_DRIFT_TOGETHER: Final = 0.008
_CURLS_CLASPED: Final = 0.5


def _drifts(
    times: Floats, restlessness: float, rng: np.random.Generator
) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Return the drift of each hand on its own, and of both together, shape (T, 13) each."""
    slow, quick = 0.1 * restlessness, 1.0 * restlessness
    own = {hand: _DRIFT * smooth_noise(times, Channel.COUNT, slow, quick, rng) for hand in HANDS}
    left = np.zeros((len(times), Channel.COUNT))
    left[:, Channel.PLACE] = _DRIFT_TOGETHER * smooth_noise(times, 3, slow, quick, rng)
    right = left.copy()
    right[:, 0] *= -1
    return own, dict(zip(HANDS, (left, right), strict=True))


def _with_idling(course: Floats, own: Floats, together: Floats, beats: Floats) -> Floats:
    """Return the course, shape (T, 13), with drift, and small beats on accents at rest."""
    free = np.repeat(course[:, _ALONE, None], Channel.COUNT, axis=1)
    free[:, Channel.CURLS] = np.maximum(free[:, Channel.CURLS], _CURLS_CLASPED)
    beat = course[:, _RESTING, None] * (beats[:, None] * _BEAT)
    beat[:, Channel.PLACE.stop :] *= free[:, Channel.PLACE.stop :]
    return np.asarray(course[:, : Channel.COUNT] + beat + free * own + (1 - free) * together)
