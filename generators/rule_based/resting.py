"""How both hands rest between gestures: nobody keeps one pose."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from generators.rule_based.emotion_style import GestureManner
from generators.rule_based.gesture_plan import HANDS, Gesture, endings
from generators.rule_based.hand_pose import (
    BEFORE_THE_WAIST,
    CLASPED_OVER,
    CLASPED_UNDER,
    HANGING_SLACK,
    HELD_OFF,
    HandPose,
)

SETTLING: Final = 1.2
"""Seconds that an unmoved speaker takes from one rest pose to the next."""

_LASTS: Final = (1.8, 4.0)
"""Seconds that a rest pose lasts, at least and at most."""

_OWN: Final = 0.3
"""Probability that both hands are as the emotion holds them."""

_CLASPED: Final = (CLASPED_OVER, CLASPED_UNDER)
_AT_THE_SIDES: Final = (HELD_OFF, HELD_OFF)
_ONE_HANGS: Final = (BEFORE_THE_WAIST, HELD_OFF)

_OTHERS: Final[Mapping[HandPose, Sequence[tuple[HandPose, HandPose]]]] = {
    BEFORE_THE_WAIST: (_CLASPED, _AT_THE_SIDES, _ONE_HANGS),
    HELD_OFF: (_CLASPED, _AT_THE_SIDES, _ONE_HANGS),
    HANGING_SLACK: (_CLASPED,),
}
"""What a feeling changes its own pose for: that of the hand that gestures next, and the other's."""


@dataclass(frozen=True, kw_only=True)
class Rest:
    """How the hands rest from a moment on.

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
        return CLASPED_OVER in self.poses.values()


def plan_rests(
    manner: GestureManner, gestures: Sequence[Gesture], seconds: float, rng: np.random.Generator
) -> tuple[Rest, ...]:
    """Return how the hands rest, should they, at each time of a clip.

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
    own = dict.fromkeys(HANDS, manner.rest)
    rests: list[Rest] = []
    for start, end, leaving in _both_free(manner, gestures, seconds):
        begin = start
        while not rests or end - begin > SETTLING / manner.tempo:
            rests.append(Rest(begin=begin, poses=_poses(own, str(rng.choice(leaving)), rng)))
            begin += rng.uniform(*_LASTS)
        if rests[-1].clasped:
            rests.append(Rest(begin=end, poses=own))
    return tuple(rests)


def _both_free(
    manner: GestureManner, gestures: Sequence[Gesture], seconds: float
) -> Iterator[tuple[float, float, Sequence[str]]]:
    """Yield from when to when no hand gestures, the first time from 0 on, and which do next."""
    released = 0.0
    ends = {
        (gesture.begin, hand): ending.release
        for hand in HANDS
        for own in [[gesture for gesture in gestures if hand in gesture.hands]]
        for gesture, ending in zip(own, endings(own, manner.tempo), strict=True)
    }
    for gesture in gestures:
        yield released, gesture.begin, gesture.hands
        released = max(released, *(ends[gesture.begin, hand] for hand in gesture.hands))
    yield released, seconds, HANDS


def _poses(
    own: Mapping[str, HandPose], leaving: str, rng: np.random.Generator
) -> Mapping[str, HandPose]:
    """Return how both hands rest; the one that leaves first lies on the other."""
    others = _OTHERS.get(own[leaving], ())
    if not others or rng.random() < _OWN:
        return own
    leads, stays = others[int(rng.integers(len(others)))]
    return {hand: leads if hand == leaving else stays for hand in HANDS}
