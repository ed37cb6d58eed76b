"""The speakers of the corpus: traits of their motion and voice.

Their motion in each emotion is defined in ``emotions.toml``.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from motion.synthesis import PROSODY_OF_EMOTION, SpokenProsody

_NAMES: Final = (
    "ada", "ben", "cora", "dan", "eve", "finn", "gwen", "hugo",
    "ida", "jack", "kim", "leo", "mia", "noah", "olga", "pete",
)  # fmt: skip
"""As many names as voices, so that each name has its own voice."""

_DIRICHLET: Final = (0.7, 0.7, 0.7)
"""Parameters of the Dirichlet distribution of directions: most speakers have a favourite."""

_STREAM: Final = 1
"""Random stream of the speakers, separate from those of the takes."""


@dataclass(frozen=True, kw_only=True)
class CorpusSpeaker:
    """Motion parameters of one speaker.

    Attributes
    ----------
    number : int
        Number of the speaker, from 1 as in BEAT.
    name : str
        The name in file names.
    right_handed : bool
        Whether the right hand leads.
    amplitude : float
        Factor on the size of strokes, 0.75 to 1.3.
    outward, upward, forward : float
        Shares of the three directions in a stroke; they sum to 1.
    attack, release : float
        Seconds in which a stroke goes out and comes back, before the emotion's tempo is applied.
    hand_height : float
        Additional bend of the elbows in degrees, -14 to 14.
    hand_width : float
        Additional outward turn of the forearms in degrees, -8 to 10.
    elbow_width : float
        Additional distance of the upper arms from the body in degrees, -4 to 10.
    lean : float
        Additional forward lean of the trunk in degrees, -4 to 4.
    head_turn, head_tilt : float
        Degrees by which the head is turned to the left and tilted to the left.
    nod : float
        Nod at a stroke of size 1, 2 to 7 degrees.
    expressiveness : float
        Factor on the face, 0.75 to 1.25.
    restlessness : float
        Factor on drift, 0.7 to 1.4.
    """

    number: int
    name: str
    right_handed: bool
    amplitude: float
    outward: float
    upward: float
    forward: float
    attack: float
    release: float
    hand_height: float
    hand_width: float
    elbow_width: float
    lean: float
    head_turn: float
    head_tilt: float
    nod: float
    expressiveness: float
    restlessness: float


def speaker_of(number: int, seed: int) -> CorpusSpeaker:
    """Return speaker `number`, from 1, of the corpus with this seed.

    Directions are drawn from a Dirichlet distribution, all other traits uniformly from the ranges
    in `CorpusSpeaker`; three in four speakers are right-handed. A speaker does not depend on the
    number of speakers.
    """
    random = np.random.default_rng([seed, _STREAM, number])
    outward, upward, forward = random.dirichlet(_DIRICHLET).tolist()
    return CorpusSpeaker(
        number=number,
        name=_NAMES[(number - 1) % len(_NAMES)],
        right_handed=bool(random.uniform() < 0.75),
        outward=outward,
        upward=upward,
        forward=forward,
        **{trait: random.uniform(*limits) for trait, limits in read_table("traits.toml").items()},
    )


def read_table(name: str) -> dict[str, Any]:
    """Return the content of a TOML file of this package."""
    return tomllib.loads(Path(__file__).with_name(name).read_text("utf-8"))


@dataclass(frozen=True, kw_only=True)
class Voice:
    """A voice of espeak-ng.

    Attributes
    ----------
    name : str
        espeak-ng's name of the voice.
    loudness : float
        Factor on the amplitude, so that all voices are about equally loud.
    pitch : float
        Measured median fundamental frequency of neutral speech in Hz.
    """

    name: str
    loudness: float
    pitch: float


VOICES: Final = tuple(Voice(**voice) for voice in read_table("voices.toml")["voices"])

_PITCH_OF_LAPS: Final = (0, 8, -8, 14, -14)
"""Pitch shifts of voices when all have been used once, twice, …"""

_SPEED_BETWEEN_TAKES: Final = 0.05
_PITCH_BETWEEN_TAKES: Final = 4
_AMPLITUDE_BETWEEN_TAKES: Final = 0.06


def voice_of(number: int) -> Voice:
    """Return the voice of the speaker with this number, from 1."""
    return VOICES[(number - 1) % len(VOICES)]


def spoken_prosody(emotion: str, number: int, random: np.random.Generator) -> SpokenProsody:
    """Return a speaker's prosody for one take.

    Parameters
    ----------
    emotion : str
        One of `motion.segment.EMOTIONS`.
    number : int
        Number of the speaker, from 1.
    random : numpy Generator
        The take's random generator: speed varies by up to 5%, loudness by up to 6%, pitch by up to
        4 of espeak-ng's steps.
    """
    usual = PROSODY_OF_EMOTION[emotion]
    lap = _PITCH_OF_LAPS[(number - 1) // len(VOICES) % len(_PITCH_OF_LAPS)]
    speed, loudness = random.uniform(-1, 1, 2)
    pitch = usual.pitch + lap + random.integers(-_PITCH_BETWEEN_TAKES, _PITCH_BETWEEN_TAKES + 1)
    amplitude = usual.amplitude * voice_of(number).loudness
    return SpokenProsody(
        speed=round(usual.speed * (1 + _SPEED_BETWEEN_TAKES * speed)),
        pitch=int(np.clip(pitch, 0, 99)),
        pitch_range=usual.pitch_range,
        amplitude=round(amplitude * (1 + _AMPLITUDE_BETWEEN_TAKES * loudness)),
    )


@dataclass(frozen=True, kw_only=True)
class EmotionMotion:
    """Effects of an emotion on posture, gesture and face; angles in degrees.

    Attributes
    ----------
    amplitude : float
        Factor on the size of strokes.
    tempo : float
        Factor on the speed of strokes.
    spacing : float
        Smallest interval between strokes in seconds.
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
        Constant weights of ARKit's actions, in [0, 1]; a name without a side means both sides.
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


EMOTION_MOTION: Final = MappingProxyType(
    {emotion: EmotionMotion(**values) for emotion, values in read_table("emotions.toml").items()}
)
