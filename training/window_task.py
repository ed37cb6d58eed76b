"""What tasks share that learn from windows of takes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from training.data.windows import Windows

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


@dataclass(frozen=True, kw_only=True, eq=False)
class WindowTask:
    """What a `training.run.task.Task` of windows says of itself.

    Attributes
    ----------
    config : dataclass
        The network's sizes.
    weights : dataclass
        What counts how much.
    training, held_out : Windows
        Of the features that the network is told and learns to give.
    further : mapping
        What else makes this training another one than the next, as JSON values.
    device : str
        ``cpu`` or ``cuda``.
    """

    config: DataclassInstance
    weights: DataclassInstance
    training: Windows
    held_out: Windows
    further: Mapping[str, Any] = field(default_factory=dict)
    device: str = "cpu"

    @property
    def examples(self) -> int:
        """Windows to learn from."""
        return len(self.training)

    @property
    def data_sha256(self) -> str:
        """Hash of all takes and features."""
        return self.training.prepared.sha256

    @property
    def settings(self) -> dict[str, Any]:
        """What makes this training another one than the next, as JSON values."""
        return {
            **{f"network {name}": _plain(value) for name, value in asdict(self.config).items()},
            **{f"loss {name}": _plain(value) for name, value in asdict(self.weights).items()},
            **self.further,
            "device": self.device,
        }

    def tensors(self, windows: Windows, rows: NDArray[np.int64]) -> dict[str, Tensor]:
        """Return windows by feature, each (len(rows), frames, channels), on the device."""
        found = windows.batch(rows)
        return {name: torch.from_numpy(one).to(self.device) for name, one in found.items()}


def _plain(value: object) -> object:
    """Return a value as JSON holds it."""
    return [_plain(one) for one in value] if isinstance(value, tuple) else value
