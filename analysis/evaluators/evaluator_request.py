"""Which feature network a researcher asks for, and how each kind is trained by default."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from analysis.evaluators.clip_views import Channels
from analysis.evaluators.design import Kind, Size
from motion.errors import InputError
from motion.face_landmarks import FaceLandmarks
from training.config import TrainingConfig

TRAINING: Final = MappingProxyType[tuple[Kind, Size], TrainingConfig](
    {
        ("emotion", "full"): TrainingConfig(
            steps=20_000, batch_size=32, learning_rate=1e-4, weight_decay=0.01, validate_every=200
        ),
        ("emotion", "tiny"): TrainingConfig(
            steps=600, batch_size=32, learning_rate=1e-3, weight_decay=0.01, validate_every=25
        ),
        ("motion", "full"): TrainingConfig(
            steps=20_000, batch_size=128, learning_rate=5e-4, optimizer="adam", validate_every=200
        ),
        ("motion", "tiny"): TrainingConfig(
            steps=1_000, batch_size=64, learning_rate=1e-3, optimizer="adam", validate_every=50
        ),
        ("face", "full"): TrainingConfig(
            steps=20_000, batch_size=128, learning_rate=5e-4, optimizer="adam", validate_every=200
        ),
        ("face", "tiny"): TrainingConfig(
            steps=1_000, batch_size=64, learning_rate=1e-3, optimizer="adam", validate_every=50
        ),
    }
)
"""How each kind is trained unless the researcher says otherwise."""


@dataclass(frozen=True, kw_only=True)
class EvaluatorRequest:
    """Which network to train.

    Attributes
    ----------
    kind, size : str
        As in `analysis.evaluators.design`.
    channels : str
        One of `analysis.evaluators.design.CHANNELS_OF_KIND` of its kind.
    training : TrainingConfig
        How it is trained.
    frozen : tuple of str
        Channels held still in every clip, here and whenever the network looks at one.
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
                "the face is held still, and the network is to look at it",
                remedy="Remove 'face' from freeze in study.toml, or train on gestures",
            )
