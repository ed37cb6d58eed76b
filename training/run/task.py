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

    def losses(self, network: Network, rows: Ints) -> Mapping[str, Tensor]:
        """Return the losses of a batch of examples: ``loss``, which is minimised, and its parts.

        Each is a mean over the examples, so that one or several processes can compute a batch in
        parts. Randomness comes only from torch's generator, which is seeded for every part of every
        step.
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


class TaskInPasses(Task[Network], Protocol[Network]):
    """A task that is learned in several passes; see `training.config.Pass`."""

    def losses_of(self, name: str, network: Network, rows: Ints) -> Mapping[str, Tensor]:
        """Return the losses of a batch for the pass `name`, as `losses` does for a single pass.

        Meanwhile, weights that do not learn in the pass have ``requires_grad=False``.
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
        return {
            **{f"network {name}": _as_json(value) for name, value in asdict(self.config).items()},
            **{f"loss {name}": _as_json(value) for name, value in self._weights().items()},
            **self.extra_settings,
            "device": self.device,
        }

    def losses(self, network: Any, rows: Ints) -> Mapping[str, Tensor]:
        """Return the losses of a batch for a single pass that trains everything."""
        return self.losses_of("", network, rows)

    def losses_of(self, name: str, network: Any, rows: Ints) -> Mapping[str, Tensor]:
        """Return the losses of a batch for a pass."""
        raise NotImplementedError

    def _weights(self) -> Mapping[str, Any]:
        return self.weights if isinstance(self.weights, Mapping) else asdict(self.weights)

    def tensors(self, windows: Windows, rows: Ints) -> dict[str, Tensor]:
        """Return the features of windows, each (len(rows), frames, channels), on the device."""
        features = windows.batch(rows)
        return {name: torch.from_numpy(values).to(self.device) for name, values in features.items()}


def _as_json(value: object) -> object:
    """Return a value with its tuples converted to lists, as JSON returns it."""
    return [_as_json(item) for item in value] if isinstance(value, tuple) else value
