"""The kinds of feature networks, their inputs and their default training."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Final, Literal, Self

from pydantic import Field, model_validator

from analysis.evaluators.clip_views import JOINTS_OF_CHANNELS, Channels, ClipView, Face, Facts
from analysis.evaluators.networks import (
    AUTOENCODER_TINY,
    EMOTION_FULL,
    EMOTION_TINY,
    FACE_FULL,
    MOTION_FULL,
    AutoencoderConfig,
    AutoencoderNetwork,
    EmotionConfig,
    EmotionNetwork,
)
from motion.body.face_landmarks import FaceLandmarks
from motion.errors import InputError
from motion.skeleton import JOINT_NAMES
from training.config import TrainingConfig

Kind = Literal["emotion", "motion", "face"]
Size = Literal["full", "tiny"]
Network = EmotionNetwork | AutoencoderNetwork

CHANNELS_OF_KIND: Final = MappingProxyType[Kind, tuple[Channels, ...]](
    {
        "emotion": ("body",),
        "motion": ("gesture", "expression", "both"),
        "face": ("landmarks",),
    }
)
"""Possible inputs of each kind; the first is the default."""

SIZES: Final = MappingProxyType[Kind, MappingProxyType[Size, EmotionConfig | AutoencoderConfig]](
    {
        "emotion": MappingProxyType({"full": EMOTION_FULL, "tiny": EMOTION_TINY}),
        "motion": MappingProxyType({"full": MOTION_FULL, "tiny": AUTOENCODER_TINY}),
        "face": MappingProxyType({"full": FACE_FULL, "tiny": AUTOENCODER_TINY}),
    }
)


_AUTOENCODER_FULL: Final = TrainingConfig(
    steps=20_000, batch_size=128, learning_rate=5e-4, optimizer="adam", validate_every=200
)
_AUTOENCODER_TINY: Final = TrainingConfig(
    steps=1_000, batch_size=64, learning_rate=1e-3, optimizer="adam", validate_every=50
)

TRAINING: Final = MappingProxyType[tuple[Kind, Size], TrainingConfig](
    {
        ("emotion", "full"): TrainingConfig(
            steps=20_000, batch_size=32, learning_rate=1e-4, weight_decay=0.01, validate_every=200
        ),
        ("emotion", "tiny"): TrainingConfig(
            steps=600, batch_size=32, learning_rate=1e-3, weight_decay=0.01, validate_every=25
        ),
        ("motion", "full"): _AUTOENCODER_FULL,
        ("motion", "tiny"): _AUTOENCODER_TINY,
        ("face", "full"): _AUTOENCODER_FULL,
        ("face", "tiny"): _AUTOENCODER_TINY,
    }
)
"""Default training of each kind."""


class Design(Facts):
    """The kind, input and sizes of a feature network.

    Attributes
    ----------
    kind : {'emotion', 'motion', 'face'}
        AMUSE's evaluator M, an autoencoder of motion, or one of face landmarks.
    channels : str
        Its input; one of `CHANNELS_OF_KIND` of its kind.
    network : EmotionConfig or AutoencoderConfig
        Its sizes and windows.
    joints : tuple of str
        Joints whose rotations are used.
    face : {'arkit', 'expressions'} or None
        How the face is represented, if its weights are used.
    labels : tuple of str
        The emotions it classifies; empty except for the kind ``emotion``.
    frozen : tuple of str
        Channels that are frozen in its input (`motion.clip`).

    Raises
    ------
    InputError
        If the fields contradict each other.
    """

    kind: Kind
    channels: Channels
    network: EmotionConfig | AutoencoderConfig
    joints: tuple[str, ...]
    face: Face | None
    labels: tuple[Annotated[str, Field(min_length=1)], ...]
    frozen: tuple[str, ...]

    @model_validator(mode="after")
    def _fits(self) -> Self:
        fits = (
            self.channels in CHANNELS_OF_KIND[self.kind]
            and isinstance(self.network, EmotionConfig) == (self.kind == "emotion")
            and (len(self.labels) >= 2) == (self.kind == "emotion")
            and set(self.joints) <= set(JOINT_NAMES)
            and bool(self.joints) == bool(JOINTS_OF_CHANNELS[self.channels])
            and (self.face is not None) == (self.channels in ("expression", "both"))
        )
        if not fits:
            raise InputError(
                f"a network of kind {self.kind!r} does not look at {self.channels!r} with these "
                "sizes, joints, labels and face",
                remedy="Use a file as 'motionjury train evaluator' wrote it",
            )
        return self

    def view(self, landmarks: FaceLandmarks | None = None) -> ClipView:
        """Return its view of a clip.

        Parameters
        ----------
        landmarks : FaceLandmarks, optional
            Needed by the kind ``face``.
        """
        return ClipView(joints=self.joints, face=self.face, landmarks=landmarks)

    def fresh_network(self, channels: int) -> Network:
        """Return an untrained network for frames with this number of channels."""
        if isinstance(self.network, EmotionConfig):
            return EmotionNetwork(self.network, channels, len(self.labels))
        return AutoencoderNetwork(self.network, channels)

    def description(self) -> str:
        """Return the network in words."""
        if isinstance(self.network, EmotionConfig):
            return f"emotion classifier (AMUSE's M), {self.network.width} features"
        if self.kind == "face":
            return f"autoencoder of face landmarks, {self.network.features} features"
        return f"autoencoder of {_SEEN[self.channels]}, {self.network.features} features"


_SEEN: Final = MappingProxyType[Channels, str](
    {"gesture": "gestures", "expression": "expressions", "both": "gestures and expressions"}
)


@dataclass(frozen=True, kw_only=True)
class EvaluatorRequest:
    """A request to train a network.

    Attributes
    ----------
    kind, size : str
        The same as in `Kind` and `Size`.
    channels : str
        One of `CHANNELS_OF_KIND` of its kind.
    training : TrainingConfig
        Its training.
    frozen : tuple of str
        Channels frozen in every clip, in training and in use.
    landmarks : FaceLandmarks or None
        Needed by the kind ``face``.
    device : str
        ``cpu`` or ``cuda``.
    """

    kind: Kind
    size: Size
    channels: Channels
    training: TrainingConfig
    frozen: tuple[str, ...] = ()
    landmarks: FaceLandmarks | None = None
    device: str = "cpu"

    def __post_init__(self) -> None:
        if "face" in self.frozen and self.channels in ("expression", "both", "landmarks"):
            raise InputError(
                "the face is held still, but the network's input is the face",
                remedy="Remove 'face' from freeze in study.toml, or train on gestures",
            )
