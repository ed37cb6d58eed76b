"""How both hands rest between gestures: in changing poses, and never quite still."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.rule_based.emotion_style import GestureManner
from generators.rule_based.gesture_plan import HANDS, Gesture, endings
from generators.rule_based.hand_pose import (
    CHANNELS,
    CURLS,
    ELBOW_OUT,
    FLEXION,
    PLACE,
    POSES,
    PRONATION,
    HandPose,
)
from generators.rule_based.time_courses import smooth_noise

FloatArray = NDArray[np.float64]

SETTLING: Final = 1.2
"""Seconds that an unmoved speaker takes from one rest pose to the next."""

_REST_SECONDS: Final = (1.8, 4.0)
"""Seconds that a rest pose lasts, at least and at most."""

_KEEPS_REST_POSE: Final = 0.3
"""Probability that both hands are as the emotion holds them."""

_CLASPED: Final = ("clasped_over", "clasped_under")
_AT_THE_SIDES: Final = ("held_off", "held_off")
_ONE_HANGS: Final = ("before_the_waist", "held_off")

_ALTERNATIVES: Final[Mapping[HandPose, Sequence[tuple[str, str]]]] = {
    POSES["before_the_waist"]: (_CLASPED, _AT_THE_SIDES, _ONE_HANGS),
    POSES["held_off"]: (_CLASPED, _AT_THE_SIDES, _ONE_HANGS),
    POSES["hanging_slack"]: (_CLASPED,),
}
"""What a feeling changes its own pose for: that of the hand that gestures next, and the other's."""

_DRIFT: Final = 0.015
_DRIFT_TOGETHER: Final = 0.008
_TURN_DRIFT: Final = (1.5, 3.0, 2.5)
_CURL_DRIFT: Final = 0.07
_CURLS_CLASPED: Final = 0.5
_BEAT: Final = (0.0, -0.02, 0.04)
_BEAT_FLEXION: Final = -6.0
_BEAT_CURL: Final = -0.07


@dataclass(frozen=True, kw_only=True)
class Rest:
    """The resting pose of the hands from a moment on.

    Attributes
    ----------
    begin : float
        Seconds.
    poses : mapping of str to HandPose
        By hand.
    """

    begin: float
    poses: Mapping[str, HandPose]

    @property
    def clasped(self) -> bool:
        """Whether the hands lie on each other, so that they only move as one."""
        return POSES["clasped_over"] in self.poses.values()


def plan_rests(
    manner: GestureManner, gestures: Sequence[Gesture], seconds: float, rng: np.random.Generator
) -> tuple[Rest, ...]:
    """Return the resting pose of the hands at each time of a clip.

    Clenched and drawn-up hands stay what they are; others are clasped, hang, or do one of each.
    They change only where both are free for long enough, so that none meets the other on its way.

    Parameters
    ----------
    manner : GestureManner
    gestures : sequence of Gesture
        Of both hands.
    seconds : float
        Length of the clip.
    rng : numpy.random.Generator

    Returns
    -------
    tuple of Rest
        In time order, the first from 0 on.
    """
    rest_poses = dict.fromkeys(HANDS, manner.rest)
    rests: list[Rest] = []
    for start, end, leaving in _free_intervals(manner, gestures, seconds):
        begin = start
        while not rests or end - begin > SETTLING / manner.tempo:
            rests.append(Rest(begin=begin, poses=_poses(rest_poses, str(rng.choice(leaving)), rng)))
            begin += rng.uniform(*_REST_SECONDS)
        if rests[-1].clasped:
            rests.append(Rest(begin=end, poses=rest_poses))
    return tuple(rests)


def _free_intervals(
    manner: GestureManner, gestures: Sequence[Gesture], seconds: float
) -> Iterator[tuple[float, float, Sequence[str]]]:
    """Yield from when to when no hand gestures, the first time from 0 on, and which do next."""
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
    """Return the resting pose of both hands; the one that leaves first is on top."""
    alternatives = _ALTERNATIVES.get(rest_poses[leaving], ())
    if not alternatives or rng.random() < _KEEPS_REST_POSE:
        return rest_poses
    leading_pose, other_pose = alternatives[int(rng.integers(len(alternatives)))]
    return {hand: POSES[leading_pose if hand == leaving else other_pose] for hand in HANDS}


@dataclass(frozen=True, kw_only=True, eq=False)
class Idling:
    """Idle motion of the hands, in the channels of `hand_pose`, each shape (T, 13).

    Attributes
    ----------
    own : mapping of str to ndarray
        The motion of each hand.
    together : mapping of str to ndarray
        What both do as one, which leaves them where they are to each other.
    on_accents : ndarray
        A small beat on each accent while a hand rests.
    """

    own: Mapping[str, FloatArray]
    together: Mapping[str, FloatArray]
    on_accents: FloatArray

    def add_to(
        self, hand: str, course: FloatArray, *, alone: FloatArray, resting: FloatArray
    ) -> FloatArray:
        """Return the course of `hand` with what it does beside.

        Parameters
        ----------
        hand : str
        course : ndarray, shape (T, 13)
        alone : ndarray, shape (T,)
            1 where it moves by itself, 0 where it lies on the other.
        resting : ndarray, shape (T,)
            1 where it rests, 0 where it gestures.
        """
        free = np.repeat(alone[:, None], CHANNELS, axis=1)
        free[:, CURLS] = np.maximum(free[:, CURLS], _CURLS_CLASPED)
        beat = resting[:, None] * self.on_accents
        beat[:, PLACE.stop :] *= free[:, PLACE.stop :]
        return course + beat + free * self.own[hand] + (1 - free) * self.together[hand]


def idle(
    times: FloatArray, beats: FloatArray, restlessness: float, rng: np.random.Generator
) -> Idling:
    """Return the idle motion of the hands.

    Parameters
    ----------
    times : ndarray, shape (T,)
        Seconds.
    beats : ndarray, shape (T,)
        1 at the strongest accent, 0 far from all.
    restlessness : float
        Speed of the drift against an unmoved speaker's.
    rng : numpy.random.Generator
    """
    slow, quick = 0.1 * restlessness, 1.0 * restlessness
    scale = np.zeros(CHANNELS)
    scale[PLACE] = _DRIFT
    scale[[ELBOW_OUT, PRONATION, FLEXION]] = _TURN_DRIFT
    scale[CURLS] = _CURL_DRIFT
    own = {hand: scale * smooth_noise(times, CHANNELS, slow, quick, rng) for hand in HANDS}
    shared = np.zeros((len(times), CHANNELS))
    shared[:, PLACE] = _DRIFT_TOGETHER * smooth_noise(times, 3, slow, quick, rng)
    mirrored = shared.copy()
    mirrored[:, 0] *= -1
    beat = np.zeros(CHANNELS)
    beat[PLACE], beat[FLEXION], beat[CURLS] = _BEAT, _BEAT_FLEXION, _BEAT_CURL
    return Idling(
        own=own,
        together=dict(zip(HANDS, (shared, mirrored), strict=True)),
        on_accents=beats[:, None] * beat,
    )
