"""How the speakers of the corpus move in each emotion.

The eight are made to be told apart at a glance; directions follow what is known of posture and face
(Wallbott 1998, "Bodily expression of emotion"; Ekman & Friesen 1978), sizes are chosen.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
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
        Weights of ARKit's actions all the time, in [0, 1].
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


def _both(**weights: float) -> dict[str, float]:
    """Return the weights of actions that exist on both sides, alike on both."""
    return {f"{name}{side}": w for name, w in weights.items() for side in ("Left", "Right")}


EMOTION_MOTION: Final[Mapping[str, EmotionMotion]] = MappingProxyType(
    {
        "neutral": EmotionMotion(amplitude=1.0, tempo=1.0, spacing=0.45),
        "happiness": EmotionMotion(
            amplitude=1.1,
            tempo=1.05,
            spacing=0.4,
            head_down=-5,
            head_tilt=3,
            hand_height=10,
            hand_width=14,
            face=_both(mouthSmile=0.6, cheekSquint=0.4, mouthDimple=0.2, browOuterUp=0.15),
        ),
        "anger": EmotionMotion(
            amplitude=1.1,
            tempo=1.15,
            spacing=0.34,
            lean=8,
            head_down=2,
            shrug=3,
            hand_height=12,
            reach=10,
            curl=40,
            face={
                **_both(browDown=0.75, noseSneer=0.35, mouthPress=0.3, eyeSquint=0.3),
                "jawForward": 0.35,
            },
        ),
        "sadness": EmotionMotion(
            amplitude=0.7,
            tempo=0.75,
            spacing=0.65,
            lean=7,
            head_down=10,
            head_tilt=5,
            shrug=-4,
            hand_height=-34,
            hand_width=16,
            reach=8,
            curl=5,
            restlessness=0.6,
            face={
                **_both(mouthFrown=0.5, eyeLookDown=0.4, eyeBlink=0.2),
                "browInnerUp": 0.7,
                "mouthShrugLower": 0.3,
            },
        ),
        "contempt": EmotionMotion(
            amplitude=0.8,
            tempo=0.85,
            spacing=0.52,
            lean=-5,
            head_down=-9,
            head_turn=12,
            head_tilt=8,
            hand_height=-16,
            hand_width=8,
            wrist=10,
            restlessness=0.7,
            face={
                **_both(eyeSquint=0.4, eyeLookDown=0.2),
                "mouthSmileLeft": 0.5,
                "mouthDimpleLeft": 0.5,
                "mouthLeft": 0.2,
                "browOuterUpLeft": 0.4,
                "browDownRight": 0.3,
            },
        ),
        "surprise": EmotionMotion(
            amplitude=1.15,
            tempo=1.1,
            spacing=0.42,
            lean=-6,
            head_down=-7,
            shrug=6,
            hand_height=22,
            hand_width=20,
            reach=6,
            wrist=8,
            curl=-10,
            face={**_both(browOuterUp=0.55, eyeWide=0.8), "browInnerUp": 0.6, "jawOpen": 0.15},
        ),
        "fear": EmotionMotion(
            amplitude=0.8,
            tempo=1.3,
            spacing=0.38,
            lean=-7,
            head_down=4,
            shrug=10,
            hand_height=28,
            hand_width=4,
            reach=14,
            wrist=6,
            curl=28,
            restlessness=1.8,
            face={**_both(eyeWide=0.6, mouthStretch=0.55, browDown=0.1), "browInnerUp": 0.65},
        ),
        "disgust": EmotionMotion(
            amplitude=0.95,
            tempo=0.9,
            spacing=0.5,
            lean=-9,
            head_down=2,
            head_turn=-14,
            head_tilt=-5,
            shrug=4,
            hand_height=14,
            hand_width=6,
            reach=16,
            wrist=32,
            curl=-4,
            face={
                **_both(noseSneer=0.8, mouthUpperUp=0.45, browDown=0.4, cheekSquint=0.3),
                **_both(eyeSquint=0.35, mouthFrown=0.25),
            },
        ),
    }
)
