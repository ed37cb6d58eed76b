"""Parameters of an emotion; ``emotions.toml`` holds the values."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from pydantic import TypeAdapter

from generators.rule_based.hand_pose import NamedPose


@dataclass(frozen=True, kw_only=True)
class GestureManner:
    """Gesture parameters of an emotion.

    Attributes
    ----------
    forms : mapping of str to float
        Preference of each form of `gesture_plan.FORMS`; need not sum to 1.
    rest : HandPose
        Where the hands are before, after and in long pauses.
    amplitude : float
        Size of the gestures against the forms' own.
    tempo : float
        Speed of preparation, stroke and retraction against an unmoved speaker's.
    least_gap : float
        Seconds at least from one stroke to the next.
    both_hands : float
        Probability that a gesture that could be made with both hands is.
    longest_hold : float
        Seconds that a hand stays after its stroke at most.
    elbows_out : float
        Degrees by which the elbows are held off the body.
    """

    forms: Mapping[str, float]
    rest: NamedPose
    amplitude: float = 1.0
    tempo: float = 1.0
    least_gap: float = 0.6
    both_hands: float = 0.4
    longest_hold: float = 0.5
    elbows_out: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Posture:
    """The posture of an emotion; all in degrees.

    Attributes
    ----------
    spine_bend : float
        Of the whole spine, forward positive.
    lean : float
        Of the whole body from the hips, forward positive.
    shoulders_up, shoulders_forward : float
        Of the collar bones.
    head_down, head_tilt, head_turn : float
        Of neck and head together.
    """

    spine_bend: float = 0.0
    lean: float = 0.0
    shoulders_up: float = 0.0
    shoulders_forward: float = 0.0
    head_down: float = 0.0
    head_tilt: float = 0.0
    head_turn: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Liveliness:
    """Idle motion of an emotion.

    Attributes
    ----------
    nod : float
        Degrees of the head's nod on the strongest accent.
    head_drift : float
        Degrees, root mean square, of the head's slow turning.
    sway : float
        Size of the body's sway against an unmoved speaker's.
    restlessness : float
        Speed of sway and drift against an unmoved speaker's.
    breaths : float
        Breaths a minute.
    blinks : float
        Blinks a minute (about 26 in conversation, 17 at rest: Bentivoglio et al. 1997).
    looks_away : float
        Degrees, root mean square, of the gaze's wandering.
    tremor : float
        Degrees of fine trembling.
    """

    nod: float = 6.0
    head_drift: float = 3.0
    sway: float = 1.0
    restlessness: float = 1.0
    breaths: float = 15.0
    blinks: float = 24.0
    looks_away: float = 4.0
    tremor: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Face:
    """Facial parameters of an emotion.

    Attributes
    ----------
    steady : mapping of str to float
        Weights of ARKit actions that stay; a name without side means both sides.
    on_accent : mapping of str to float
        Weights added at the strongest accent.
    mouth_opening : float
        How widely the mouth opens in speech.
    """

    steady: Mapping[str, float]
    on_accent: Mapping[str, float]
    mouth_opening: float = 1.0


@dataclass(frozen=True, kw_only=True)
class EmotionStyle:
    """All that an emotion sets."""

    gestures: GestureManner
    face: Face
    posture: Posture = Posture()
    liveliness: Liveliness = Liveliness()


STYLES: Final = TypeAdapter(dict[str, EmotionStyle]).validate_python(
    tomllib.loads(Path(__file__).with_name("emotions.toml").read_text("utf-8"))
)
