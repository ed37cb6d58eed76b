"""How the speakers of the corpus move in each emotion; ``emotions.toml`` holds the values."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Final


@dataclass(frozen=True, kw_only=True)
class EmotionMotion:
    """What an emotion does to posture, gesture and face. Angles are in degrees.

    Attributes
    ----------
    amplitude : float
        Factor on the size of strokes.
    tempo : float
        Factor on how fast a stroke is.
    spacing : float
        Seconds that strokes lie apart at least.
    lean : float
        Trunk, forward.
    head_down, head_turn, head_tilt : float
        Head: chin down, turned to the left, tilted to the left.
    shrug : float
        Shoulders, up.
    hand_height : float
        Elbows, bent.
    hand_width : float
        Forearms, turned out.
    reach : float
        Upper arms, raised forward.
    wrist : float
        Hands bent back, palms to the front.
    curl : float
        Fingers, bent.
    restlessness : float
        Factor on drift.
    face : mapping
        Weights of ARKit's actions all the time, in [0, 1]; a name without side means both.
    """

    amplitude: float
    tempo: float
    spacing: float
    lean: float = 0.0
    head_down: float = 0.0
    head_turn: float = 0.0
    head_tilt: float = 0.0
    shrug: float = 0.0
    hand_height: float = 0.0
    hand_width: float = 0.0
    reach: float = 0.0
    wrist: float = 0.0
    curl: float = 0.0
    restlessness: float = 1.0
    face: Mapping[str, float] = field(default_factory=dict)


def _read() -> Mapping[str, EmotionMotion]:
    told = tomllib.loads(Path(__file__).with_name("emotions.toml").read_text("utf-8"))
    return MappingProxyType({emotion: EmotionMotion(**values) for emotion, values in told.items()})


EMOTION_MOTION: Final = _read()
