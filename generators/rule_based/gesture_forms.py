"""The gestures of the rules: position and shape of the hand, and the course of the stroke.

All are gestures that accompany speech rather than replace it: beats, and the open-hand and
precision families that work like beats (Kendon 2004, *Gesture*, ch. 12-13; McNeill 1992, ch. 3).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.rule_based.hand_pose import (
    FIST,
    FLAT,
    LOOSE_FIST,
    OPEN,
    PINCH,
    POINTING,
    RELAXED,
    WIDE,
    HandPose,
    HandShape,
)

_RELATED_SHAPES: Final[Mapping[HandShape, Sequence[HandShape]]] = {
    OPEN: (RELAXED, FLAT, WIDE),
    RELAXED: (OPEN, PINCH, FLAT),
    FLAT: (OPEN, RELAXED),
    WIDE: (OPEN,),
    PINCH: (RELAXED, OPEN),
    FIST: (LOOSE_FIST,),
    POINTING: (LOOSE_FIST,),
}
"""Shapes that a hand may come near to instead, by that of the form."""

_LARGEST_BLEND: Final = 0.5


@dataclass(frozen=True, kw_only=True)
class GestureForm:
    """One kind of gesture.

    Attributes
    ----------
    apex : HandPose
        The hand at the end of the stroke, at amplitude 1.
    stroke : tuple of float
        The way of the wrist in the stroke (outward, up, forward), in arm lengths.
    wind_up : tuple of float
        Degrees by which pronation and flexion differ at the stroke's beginning.
    wind_up_shape : HandShape
        The fingers at the stroke's beginning.
    one_hand, both_hands : bool
        With what it can be done.
    """

    apex: HandPose
    stroke: tuple[float, float, float]
    wind_up: tuple[float, float]
    wind_up_shape: HandShape = RELAXED
    one_hand: bool = True
    both_hands: bool = True

    def fingers(self, rng: np.random.Generator) -> NDArray[np.float64]:
        """Return how one stroke ends, shape (6,): curls and spread, part way to a shape of kin."""
        shape = self.apex.shape
        related = _RELATED_SHAPES[shape][int(rng.integers(len(_RELATED_SHAPES[shape])))]
        blend = rng.uniform(0, _LARGEST_BLEND)
        return (1 - blend) * np.array(astuple(shape)) + blend * np.array(astuple(related))


def _apex(
    place: tuple[float, float, float],
    shape: HandShape,
    *,
    pronation: float,
    flexion: float,
    deviation: float = 0,
    elbow_out: float = 0,
) -> HandPose:
    outward, up, forward = place
    return HandPose(
        outward=outward,
        up=up,
        forward=forward,
        elbow_out=elbow_out,
        pronation=pronation,
        flexion=flexion,
        deviation=deviation,
        shape=shape,
    )


FORMS: Final = MappingProxyType(
    {
        "beat": GestureForm(
            apex=_apex((-0.02, -0.46, 0.60), RELAXED, pronation=24, flexion=2),
            stroke=(0.03, -0.24, 0.06),
            wind_up=(-10, -32),
        ),
        "offer": GestureForm(
            apex=_apex((0.08, -0.46, 0.66), OPEN, pronation=-62, flexion=-10),
            stroke=(0.14, -0.12, 0.20),
            wind_up=(70, 18),
        ),
        "chop": GestureForm(
            apex=_apex((-0.06, -0.44, 0.66), FLAT, pronation=2, flexion=0, deviation=-8),
            stroke=(0.0, -0.30, 0.12),
            wind_up=(0, 0),
            wind_up_shape=FLAT,
        ),
        "frame": GestureForm(
            apex=_apex((0.06, -0.34, 0.60), OPEN, pronation=12, flexion=4, deviation=4),
            stroke=(0.12, -0.14, 0.08),
            wind_up=(18, 12),
            one_hand=False,
        ),
        "precision": GestureForm(
            apex=_apex((-0.06, -0.28, 0.60), PINCH, pronation=22, flexion=-8),
            stroke=(0.02, -0.20, 0.08),
            wind_up=(-8, -26),
            both_hands=False,
        ),
        "sweep": GestureForm(
            apex=_apex((0.38, -0.36, 0.60), OPEN, pronation=30, flexion=-16, elbow_out=0),
            stroke=(0.44, -0.04, -0.02),
            wind_up=(-10, 22),
        ),
        "to_self": GestureForm(
            apex=_apex((-0.22, -0.30, 0.45), OPEN, pronation=14, flexion=14, elbow_out=14),
            stroke=(-0.16, 0.02, -0.20),
            wind_up=(-24, -14),
            both_hands=False,
        ),
        "ward_off": GestureForm(
            apex=_apex((0.06, -0.22, 0.58), WIDE, pronation=70, flexion=-56),
            stroke=(0.05, 0.04, 0.24),
            wind_up=(-18, 20),
        ),
        "throw_up": GestureForm(
            apex=_apex((0.30, -0.20, 0.44), WIDE, pronation=4, flexion=-22),
            stroke=(0.18, 0.26, 0.0),
            wind_up=(10, 20),
        ),
        "dismiss": GestureForm(
            apex=_apex((0.32, -0.40, 0.60), RELAXED, pronation=28, flexion=-26),
            stroke=(0.28, 0.03, 0.10),
            wind_up=(22, 48),
            both_hands=False,
        ),
        "fist": GestureForm(
            apex=_apex((-0.04, -0.42, 0.58), FIST, pronation=24, flexion=6, elbow_out=6),
            stroke=(0.02, -0.32, 0.14),
            wind_up=(-6, -10),
            wind_up_shape=LOOSE_FIST,
        ),
        "point": GestureForm(
            apex=_apex((-0.02, -0.26, 0.68), POINTING, pronation=40, flexion=6),
            stroke=(0.0, -0.18, 0.20),
            wind_up=(-26, -18),
            wind_up_shape=LOOSE_FIST,
            both_hands=False,
        ),
        "sag": GestureForm(
            apex=_apex((0.06, -0.66, 0.50), RELAXED, pronation=-40, flexion=-4),
            stroke=(0.10, -0.08, 0.10),
            wind_up=(40, 8),
        ),
    }
)
"""Gesture forms by name."""
