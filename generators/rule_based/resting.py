"""How both hands rest between gestures: nobody keeps one pose, nor holds it quite still."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from generators.rule_based.emotion_style import GestureManner
from generators.rule_based.gesture_plan import HANDS
from generators.rule_based.hand_pose import BEFORE_THE_WAIST, HELD_OFF, HandPose

_LASTS: Final = (1.8, 4.0)
"""Seconds that a rest pose lasts, at least and at most."""

_PLAIN: Final = (BEFORE_THE_WAIST, HELD_OFF)
"""Poses that say nothing of a feeling, and change for one another: together, and down."""

_OWN: Final = 0.4
"""Probability that both hands are as the emotion holds them."""


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


def plan_rests(manner: GestureManner, seconds: float, rng: np.random.Generator) -> tuple[Rest, ...]:
    """Return how the hands rest, should they, at each time of a clip.

    Clenched, drawn-up and slack hands stay what they are; others lie together, hang, or do one of
    each.

    Parameters
    ----------
    manner : GestureManner
    seconds : float
        Length of the clip.
    rng : numpy.random.Generator

    Returns
    -------
    tuple of Rest
        In time order, the first from 0 on.
    """
    rests: list[Rest] = []
    begin = 0.0
    while begin < seconds or not rests:
        poses = dict.fromkeys(HANDS, manner.rest)
        if manner.rest in _PLAIN and rng.random() > _OWN:
            poses = {hand: _PLAIN[int(rng.integers(len(_PLAIN)))] for hand in HANDS}
        rests.append(Rest(begin=begin, poses=poses))
        begin += rng.uniform(*_LASTS)
    return tuple(rests)
