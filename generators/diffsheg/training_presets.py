"""How each DiffSHEG network is trained unless the researcher says otherwise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final

from generators.diffsheg.config import BEAT, SHOW, TINY, DenoiserConfig
from generators.training.batch_order import batches_per_epoch
from generators.training.config import TrainingConfig
from motion.errors import InputError

STRIDE: Final = 10
"""Frames from one window to the next, as for BEAT in the release; of SHOW nothing is told."""


@dataclass(frozen=True, kw_only=True)
class TrainingPreset:
    """Sizes and training of one network.

    Attributes
    ----------
    network : DenoiserConfig
        Its sizes; speakers are those of the takes.
    losses : str
        One of `generators.diffsheg.losses.LOSSES`.
    training : TrainingConfig
        How; its steps are those of one epoch where `epochs` are told.
    epochs : int or None
        How often all windows are gone through, in place of a number of steps.
    """

    network: DenoiserConfig
    losses: str
    training: TrainingConfig
    epochs: int | None = None

    def trained_on(self, examples: int, changes: Mapping[str, Any]) -> TrainingConfig:
        """Return how it is trained on so many examples, with some settings changed."""
        config = replace(self.training, **changes)
        if self.epochs is None or "steps" in changes:
            return config
        return replace(config, steps=self.epochs * batches_per_epoch(examples, config.batch_size))


_TINY_TRAINING: Final = TrainingConfig(
    steps=3_500,
    batch_size=32,
    learning_rate=2e-3,
    optimizer="adam",
    gradient_clip=0.5,
    ema_decay=0.995,
    validate_every=100,
    checkpoint_every=250,
)


def _full(batch_size: int) -> TrainingConfig:
    return TrainingConfig(
        steps=1,
        batch_size=batch_size,
        learning_rate=2e-4,
        optimizer="adam",
        gradient_clip=0.5,
        validate_every=500,
        checkpoint_every=500,
    )


PRESETS: Final[Mapping[tuple[str, str], TrainingPreset]] = MappingProxyType(
    {
        ("beat", "beat"): TrainingPreset(
            network=BEAT, losses="paper", training=_full(2_500), epochs=1_000
        ),
        ("show", "show"): TrainingPreset(
            network=SHOW, losses="paper", training=_full(950), epochs=1_600
        ),
        ("tiny", "beat"): TrainingPreset(network=TINY, losses="steps", training=_TINY_TRAINING),
        ("tiny", "show"): TrainingPreset(
            network=replace(
                TINY,
                gesture_width=SHOW.gesture_width,
                expression_width=SHOW.expression_width,
                speakers=SHOW.speakers,
                frames=SHOW.frames,
                frame_rate=SHOW.frame_rate,
            ),
            losses="steps",
            training=_TINY_TRAINING,
        ),
    }
)
"""By config and by whose motion it tells. Those of the released sizes are trained as the paper says
(section 4.2): Adam with rate 2e-4, gradients clipped at .5, and its epochs and batches."""

ABLATIONS: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "naive_concat": {"flow": "joint"},
        "without_detach": {"detached": False},
        "without_x0": {"flow": "none"},
        "reverse": {"flow": "gesture_to_expression"},
    }
)
"""What the ablations of Table 1 change in the network."""


def preset_of(config: str, dataset: str) -> TrainingPreset:
    """Return the preset of a config for the motion of a data set.

    Raises
    ------
    InputError
        If the config is of the other data set.
    """
    found = PRESETS.get((config, dataset))
    if found is None:
        fitting = [name for name, of in PRESETS if of == dataset]
        raise InputError(
            f"the config {config} does not tell the motion of these recordings, which is told "
            f"as {dataset.upper()}'s",
            remedy=f"Use --config {' or '.join(fitting)}",
        )
    return found
