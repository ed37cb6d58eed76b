"""Settings of a training."""

import json
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Final, Literal, TypeVar

from pydantic import ConfigDict, TypeAdapter

from training.run.batches import batches_per_epoch

Optimizer = Literal["adam", "adamw"]
Precision = Literal["float32", "bfloat16"]

CHANGEABLE_SETTINGS: Final = ("training steps", "training checkpoint_every")
"""Settings that may change when a run is resumed; they do not affect steps already made."""


@dataclass(frozen=True, kw_only=True)
class Decay:
    """Exponential decay of the learning rate over epochs.

    Attributes
    ----------
    factor : float
        Factor per epoch, above 0 and at most 1.
    from_epoch : int
        The first epoch with a reduced rate, counted from 0. The next one has the square of the
        factor, and so on.
    """

    factor: float
    from_epoch: int = 1

    def __call__(self, epoch: int) -> float:
        """Return the factor of the learning rate in `epoch`."""
        return float(self.factor ** max(0, epoch - self.from_epoch + 1))


@dataclass(frozen=True, kw_only=True)
class Pass:
    """An update of some weights by one loss.

    The passes of a step are made in order: the second one uses the weights that the first one
    changed. Weights that belong to none of the passes of a stage are frozen in it.

    Attributes
    ----------
    name : str
        Its name for the task and in the log.
    parts : tuple of str
        Names of the modules or weights that learn, as in ``named_modules``; empty for the whole
        network.
    learning_rate : float or None
        Its learning rate, which decays as the training's does; None for the training's.
    first : int
        The first step of its stage, counted from 0.
    end : int or None
        The step before which its stage ends; None for the end of the training.
    """

    name: str
    parts: tuple[str, ...] = ()
    learning_rate: float | None = None
    first: int = 0
    end: int | None = None

    def in_stage(self, step: int) -> bool:
        """Return whether a step, counted from 0, belongs to the pass' stage, and makes it."""
        return self.first <= step and (self.end is None or step < self.end)


@dataclass(frozen=True, kw_only=True)
class TrainingConfig:
    """Settings of a training.

    Attributes
    ----------
    steps : int
        Number of updates of the weights, at least 1.
    batch_size : int
        Number of examples per update, at least 1; all of them if there are fewer.
    accumulate : int
        Number of parts into which the examples of an update are divided, at least 1. Gradients are
        summed over the parts, so that memory holds only one. Several processes share the parts, and
        make more of them if there are too few: see `training.run.batches.step_parts`.
    learning_rate : float
        Initial learning rate, above 0 and at most 1.
    decay : Decay or None
        Decay of the learning rate over epochs; None for a constant rate.
    optimizer : {'adam', 'adamw'}
        Adam (Kingma & Ba 2015), or AdamW with decoupled weight decay (Loshchilov & Hutter 2019).
    betas : pair of float
        Decay of the optimizer's two running means, each in [0, 1).
    weight_decay : float
        Weight decay, at least 0.
    gradient_clip : float or None
        Largest norm of the gradient over all weights; larger gradients are scaled down to it.
    ema_decay : float or None
        Decay per step of an exponential moving average of the weights, in (0, 1). Validation and
        the resulting network use the average. None for no average. See `training.run.learner`.
    precision : {'float32', 'bfloat16'}
        Precision of the layers that tolerate less than float32 (torch's autocast); weights stay
        float32.
    validate_every : int
        Steps between validations; there is always one after the last step.
    checkpoint_every : int
        Steps between checkpoints; the state is also saved at the end and when interrupted.
    seed : int
        Seed of the initial weights, the order of examples and dropout.
    passes : tuple of Pass
        The updates of a step, in order; empty for one update of all weights.
    """

    steps: int
    batch_size: int
    learning_rate: float
    accumulate: int = 1
    decay: Decay | None = None
    optimizer: Optimizer = "adamw"
    betas: tuple[float, float] = (0.9, 0.999)
    weight_decay: float = 0.0
    gradient_clip: float | None = 1.0
    ema_decay: float | None = None
    precision: Precision = "float32"
    validate_every: int = 100
    checkpoint_every: int = 500
    seed: int = 0
    passes: tuple[Pass, ...] = ()

    def facts(self) -> dict[str, Any]:
        """Return the settings as JSON values."""
        facts: dict[str, Any] = json.loads(json.dumps(asdict(self)))
        return facts


@dataclass(frozen=True, kw_only=True)
class Preset:
    """Default settings of a training.

    Attributes
    ----------
    training : TrainingConfig
        The settings; `epochs`, if given, overrides their number of steps.
    epochs : int or None
        Number of epochs; None for the number of steps in `training`.
    """

    training: TrainingConfig
    epochs: int | None = None

    def config_for(self, examples: int, changes: Mapping[str, Any]) -> TrainingConfig:
        """Return the settings for a number of training examples, with `changes` applied.

        Epochs are converted to steps, unless the changes set a number of steps.
        """
        config = replace(self.training, **changes)
        if self.epochs is None or "steps" in changes:
            return config
        steps = self.epochs * batches_per_epoch(examples, config.batch_size)
        return replace(config, steps=steps)


Table = TypeVar("Table")


def read_presets(file: Path, kind: type[Table]) -> Mapping[str, Table]:
    """Return the tables of a TOML file by name, each as the type `kind`, without unknown keys."""
    tables = tomllib.loads(file.read_text("utf-8"))
    adapter = TypeAdapter(dict[str, kind], config=ConfigDict(extra="forbid"))  # type: ignore[valid-type]
    return adapter.validate_python(tables)
