"""Hand shapes and poses, gesture forms, and the style of each emotion.

The values are in the TOML files of this package.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Annotated, Any, Final

import numpy as np
from pydantic import BeforeValidator, TypeAdapter

from motion.arrays import Floats

_LARGEST_BLEND: Final = 0.5


def _table(name: str) -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name(name).read_text("utf-8"))


@dataclass(frozen=True, kw_only=True)
class HandShape:
    """Curl of each finger, 0 straight and 1 in a fist, and spread of the fingers."""

    thumb: float
    index: float
    middle: float
    ring: float
    pinky: float
    spread: float


_HANDS: Final = _table("hands.toml")

SHAPES: Final = {name: HandShape(**values) for name, values in _HANDS["shapes"].items()}

RELATED_SHAPES: Final[Mapping[HandShape, Sequence[HandShape]]] = {
    SHAPES[name]: [SHAPES[other] for other in others] for name, others in _HANDS["related"].items()
}
"""Shapes towards which a hand may vary."""

NamedShape = Annotated[HandShape, BeforeValidator(lambda name: SHAPES[name])]
"""A shape, given by its name in a table."""


@dataclass(frozen=True, kw_only=True)
class HandPose:
    """Position and orientation of a hand.

    Attributes
    ----------
    outward, up, forward : float
        Vector from the shoulder to the wrist in the chest's frame, in arm lengths (shoulder to
        wrist); outward is away from the other arm.
    elbow_out : float
        Angle in degrees by which the elbow is raised sideways from where it hangs.
    pronation : float
        Turn of the forearm in degrees: 0 with the thumb up, +80 palm down, -80 palm up.
    flexion : float
        Bend of the wrist towards the palm, in degrees.
    deviation : float
        Bend of the wrist towards the thumb, in degrees.
    shape : HandShape
    """

    outward: float
    up: float
    forward: float
    elbow_out: float = 0
    pronation: float
    flexion: float
    deviation: float = 0
    shape: NamedShape

    def channels(self) -> Floats:
        """Return the pose as a vector, shape (13,), whose parts are those of `Channel`."""
        *arm, shape = astuple(self)
        return np.array([*arm, *shape], float)


POSES: Final = TypeAdapter(dict[str, HandPose]).validate_python(_HANDS["poses"])

NamedPose = Annotated[HandPose, BeforeValidator(lambda name: POSES[name])]
"""A pose, given by its name in a table."""


class Channel:
    """The parts of a `HandPose` as a vector."""

    PLACE: Final = slice(0, 3)
    ELBOW_OUT: Final = 3
    PRONATION: Final = 4
    FLEXION: Final = 5
    DEVIATION: Final = 6
    CURLS: Final = slice(7, 12)
    SPREAD: Final = 12
    COUNT: Final = 13


@dataclass(frozen=True, kw_only=True)
class GestureForm:
    """One kind of gesture.

    Attributes
    ----------
    apex : HandPose
        The hand at the end of the stroke, at amplitude 1.
    stroke : tuple of float
        Path of the wrist in the stroke (outward, up, forward), in arm lengths.
    wind_up : tuple of float
        Differences of pronation and flexion at the start of the stroke, in degrees.
    wind_up_shape : HandShape
        The fingers at the start of the stroke.
    one_hand, both_hands : bool
        Whether one hand, or both hands, can make it.
    """

    apex: HandPose
    stroke: tuple[float, float, float]
    wind_up: tuple[float, float]
    wind_up_shape: NamedShape = SHAPES["relaxed"]
    one_hand: bool = True
    both_hands: bool = True

    def fingers(self, rng: np.random.Generator) -> Floats:
        """Return curls and spread after a stroke, shape (6,), varied towards a related shape."""
        related = RELATED_SHAPES[self.apex.shape]
        target = related[int(rng.integers(len(related)))]
        blend = rng.uniform(0, _LARGEST_BLEND)
        return (1 - blend) * np.array(astuple(self.apex.shape)) + blend * np.array(astuple(target))


FORMS: Final = TypeAdapter(dict[str, GestureForm]).validate_python(_table("forms.toml"))
"""Gesture forms by name."""


@dataclass(frozen=True, kw_only=True)
class GestureManner:
    """Gesture parameters of an emotion.

    Attributes
    ----------
    forms : mapping of str to float
        Preference of each form of `FORMS`; need not sum to 1.
    rest : HandPose
        Pose of the hands before and after gestures and in long pauses.
    amplitude : float
        Size of the gestures relative to the forms.
    tempo : float
        Speed of preparation, stroke and retraction relative to a neutral speaker.
    least_gap : float
        Shortest time from one stroke to the next, in seconds.
    both_hands : float
        Probability of using both hands if the gesture allows it.
    longest_hold : float
        Longest hold after a stroke, in seconds.
    elbows_out : float
        Angle in degrees by which the elbows are held off the body.
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
    """The posture of an emotion, in degrees.

    Attributes
    ----------
    spine_bend : float
        Bend of the whole spine, forward positive.
    lean : float
        Lean of the whole body from the hips, forward positive.
    shoulders_up, shoulders_forward : float
        Rotations of the collar bones.
    head_down, head_tilt, head_turn : float
        Rotations of neck and head together.
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
        The head's nod on the strongest accent, in degrees.
    head_drift : float
        Root mean square of the head's slow turning, in degrees.
    sway : float
        Size of the body's sway relative to a neutral speaker.
    restlessness : float
        Speed of sway and drift relative to a neutral speaker.
    breaths : float
        Breaths per minute.
    blinks : float
        Blinks per minute (about 26 in conversation, 17 at rest: Bentivoglio et al. 1997).
    looks_away : float
        Root mean square of the gaze's wandering, in degrees.
    tremor : float
        Root mean square of the shoulders' trembling, in degrees.
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
        Constant weights of ARKit actions; a name without a side means both sides.
    on_accent : mapping of str to float
        Weights added at the strongest accent.
    mouth_opening : float
        Scale of the mouth's opening in speech.
    """

    steady: Mapping[str, float]
    on_accent: Mapping[str, float]
    mouth_opening: float = 1.0


@dataclass(frozen=True, kw_only=True)
class EmotionStyle:
    """All parameters of an emotion."""

    gestures: GestureManner
    face: Face
    posture: Posture = Posture()
    liveliness: Liveliness = Liveliness()


STYLES: Final = TypeAdapter(dict[str, EmotionStyle]).validate_python(_table("emotions.toml"))
"""Styles by emotion."""
