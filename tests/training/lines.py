"""A task of a thousandth of a second: learning a line, through dropout and batch statistics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

_CHANCE = np.random.default_rng(7)
ENTRIES = torch.from_numpy(_CHANCE.standard_normal((40, 3)).astype(np.float32))
VALUES = ENTRIES @ torch.tensor([[1.0], [-2.0], [0.5]])


@dataclass(frozen=True, kw_only=True)
class Line:
    """Learns from 32 examples; eight are kept back."""

    settings: Mapping[str, Any] = field(default_factory=lambda: {"kind": "line"})
    data_sha256: str = "a" * 64
    examples: int = 32
    device: str = "cpu"
    factor: float = 1.0

    def network(self) -> nn.Sequential:
        return nn.Sequential(
            nn.Linear(3, 8), nn.BatchNorm1d(8), nn.ReLU(), nn.Dropout(0.2), nn.Linear(8, 1)
        )

    def losses(self, network: nn.Sequential, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        chosen = torch.from_numpy(rows)
        loss = nn.functional.mse_loss(network(ENTRIES[chosen]), VALUES[chosen])
        return {"loss": self.factor * loss}

    def validation(self, network: nn.Sequential) -> Mapping[str, float]:
        assert not network.training
        assert not torch.is_grad_enabled()
        # What is drawn here must leave no trace in the steps that follow.
        torch.rand(5)
        return {"loss": float(nn.functional.mse_loss(network(ENTRIES[32:]), VALUES[32:]))}

    def validation_of(self, network: nn.Sequential) -> Mapping[str, float]:
        """Return what is measured of a network outside of training."""
        with torch.no_grad():
            return self.validation(network.eval())
