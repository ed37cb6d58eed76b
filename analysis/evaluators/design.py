"""What kind of feature network one is: what it sees of a clip, its sizes, what it tells apart."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from analysis.evaluators import autoencoder_network, emotion_network
from analysis.evaluators.autoencoder_network import AutoencoderConfig, AutoencoderNetwork
from analysis.evaluators.clip_views import (
    JOINTS_OF_CHANNELS,
    Channels,
    ClipView,
    Face,
    view_of,
)
from analysis.evaluators.emotion_network import EmotionConfig, EmotionNetwork
from motion.errors import InputError
from motion.face_landmarks import FaceLandmarks
from motion.skeleton import JOINT_NAMES

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
"""What each kind may look at; the first unless another is asked for."""

SIZES: Final = MappingProxyType[Kind, MappingProxyType[Size, EmotionConfig | AutoencoderConfig]](
    {
        "emotion": MappingProxyType({"full": emotion_network.FULL, "tiny": emotion_network.TINY}),
        "motion": MappingProxyType(
            {"full": autoencoder_network.MOTION_FULL, "tiny": autoencoder_network.SMALL}
        ),
        "face": MappingProxyType(
            {"full": autoencoder_network.FACE_FULL, "tiny": autoencoder_network.SMALL}
        ),
    }
)


@dataclass(frozen=True, kw_only=True)
class Design:
    """What kind of feature network one is.

    Attributes
    ----------
    kind : {'emotion', 'motion', 'face'}
        AMUSE's evaluator M, an autoencoder of motion, or one of face landmarks.
    channels : str
        What it looks at; one of `CHANNELS_OF_KIND` of its kind.
    config : EmotionConfig or AutoencoderConfig
        Its sizes and windows.
    joints : tuple of str
        Joints whose rotations it sees.
    face : {'arkit', 'expressions'} or None
        In which terms it sees the face, where it sees its weights.
    labels : tuple of str
        The emotions it tells apart; empty but for the kind ``emotion``.
    frozen : tuple of str
        Channels that are held still before it looks (`motion.freeze`).

    Raises
    ------
    InputError
        If the parts do not fit together.
    """

    kind: Kind
    channels: Channels
    config: EmotionConfig | AutoencoderConfig
    joints: tuple[str, ...] = ()
    face: Face | None = None
    labels: tuple[str, ...] = ()
    frozen: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        fits = (
            self.channels in CHANNELS_OF_KIND[self.kind]
            and isinstance(self.config, EmotionConfig) == (self.kind == "emotion")
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

    def view(self, landmarks: FaceLandmarks | None = None) -> ClipView:
        """Return what it sees of a clip.

        Parameters
        ----------
        landmarks : FaceLandmarks, optional
            Needed by the kind ``face``.
        """
        return view_of(self.channels, joints=self.joints, face=self.face, landmarks=landmarks)

    def network(self, channels: int) -> Network:
        """Return a fresh network for frames of so many channels."""
        if isinstance(self.config, EmotionConfig):
            return EmotionNetwork(self.config, channels, len(self.labels))
        return AutoencoderNetwork(self.config, channels)

    def named(self) -> str:
        """Return what the network is, in words."""
        if isinstance(self.config, EmotionConfig):
            return f"emotion classifier (AMUSE's M), {self.config.width} features"
        if self.kind == "face":
            return f"autoencoder of face landmarks, {self.config.features} features"
        return f"autoencoder of {_SEEN[self.channels]}, {self.config.features} features"


_SEEN: Final = MappingProxyType[Channels, str](
    {"gesture": "gestures", "expression": "expressions", "both": "gestures and expressions"}
)
