"""The task of a training: network, examples and loss; and tasks of windows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import torch
from torch import Tensor, nn

from motion.arrays import Ints
from training.data.windows import Windows

Network = TypeVar("Network", bound=nn.Module)


class Task(Protocol[Network]):
    """A task to learn."""

    @property
    def settings(self) -> Mapping[str, Any]:
        """The identity of this task, as JSON values: kind, sizes, labels."""
        ...

    @property
    def data_sha256(self) -> str:
        """Hash of all examples, held-out ones included."""
        ...

    @property
    def examples(self) -> int:
        """The number of training examples."""
        ...

    @property
    def device(self) -> str:
        """The device: ``cpu`` or ``cuda``."""
        ...

    def network(self) -> Network:
        """Return a new network on the device, initialised with torch's random generator."""
        ...

    def losses(self, network: Network, rows: Ints, name: str) -> Mapping[str, Tensor]:
        """Return the losses of a batch of examples: ``loss``, which is minimised, and its parts.

        `name` is the pass (`training.config.Pass`), empty if a step has only one. Weights that do
        not learn in it have ``requires_grad=False``. Each loss is a mean over the examples, so that
        one or several processes can compute a batch in parts. Randomness comes only from torch's
        generator, which is seeded for every part of every step.
        """
        ...

    def validation(self, network: Network) -> Mapping[str, float]:
        """Return the measures of held-out examples; the first one selects the best weights.

        The weights of the step with the smallest first measure, whatever its name, are kept. It
        should reflect the purpose of the network, which the sum of all losses may not, and use
        enough examples to distinguish steps.

        The network is in evaluation mode, without gradients. torch's generator has the same seed
        each time, so that every step is measured with the same noise.
        """
        ...


if TYPE_CHECKING:
    from _typeshed import DataclassInstance


@dataclass(frozen=True, kw_only=True, eq=False)
class WindowTask:
    """The description of a `training.run.task.Task` of windows.

    Attributes
    ----------
    config : dataclass
        The network's sizes.
    weights : dataclass or mapping of str to float
        Weights of the losses.
    training, held_out : Windows
        Windows of the network's conditions and targets.
    extra_settings : mapping
        Further identity of this training, as JSON values.
    device : str
        ``cpu`` or ``cuda``.
    """

    config: DataclassInstance
    weights: DataclassInstance | Mapping[str, float]
    training: Windows
    held_out: Windows
    extra_settings: Mapping[str, Any] = field(default_factory=dict)
    device: str = "cpu"

    @property
    def examples(self) -> int:
        """The number of training windows."""
        return len(self.training)

    @property
    def data_sha256(self) -> str:
        """Hash of all takes and features."""
        return self.training.prepared.sha256

    @property
    def settings(self) -> dict[str, Any]:
        """The identity of this training, as JSON values."""
        weights = self.weights if isinstance(self.weights, Mapping) else asdict(self.weights)
        settings: dict[str, Any] = {
            **{f"network {name}": value for name, value in asdict(self.config).items()},
            **{f"loss {name}": value for name, value in weights.items()},
            **self.extra_settings,
            "device": self.device,
        }
        return settings

    def tensors(self, windows: Windows, rows: Ints) -> dict[str, Tensor]:
        """Return the features of windows, each (len(rows), frames, channels), on the device."""
        features = windows.batch(rows)
        return {name: torch.from_numpy(values).to(self.device) for name, values in features.items()}
