"""What a feature network learns from, and how well it does on what was kept back."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from analysis.evaluators.design import Network
from analysis.evaluators.examples import Examples

_AT_ONCE: Final = 64


@dataclass(frozen=True, kw_only=True, eq=False)
class FeatureTask:
    """Learning a feature network, which says itself what its losses are.

    Attributes
    ----------
    fresh : callable
        Makes the network for frames of so many channels.
    training, held_out : Examples
        Windows.
    settings : mapping
        What makes this task another one than the next.
    data_sha256 : str
        Hash of all clips.
    device : str
        ``cpu`` or ``cuda``.
    """

    fresh: Callable[[int], Network]
    training: Examples
    held_out: Examples
    settings: Mapping[str, Any]
    data_sha256: str
    device: str = "cpu"

    @property
    def examples(self) -> int:
        """Windows to learn from."""
        return len(self.training)

    def network(self) -> Network:
        """Return a fresh network."""
        return self.fresh(self.training.frames.shape[1]).to(self.device)

    def losses(self, network: Network, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        """Return the losses of a batch."""
        return network.losses(*self.training.batch(rows))

    def validation(self, network: Network) -> Mapping[str, float]:
        """Return what the network measures of the windows kept back, the loss first."""
        sums: defaultdict[str, float] = defaultdict(float)
        for windows, labels in self.held_out.batches(_AT_ONCE):
            for name, value in network.measured(windows, labels).items():
                sums[name] += float(value) * len(windows)
        return {name: value / len(self.held_out) for name, value in sums.items()}
