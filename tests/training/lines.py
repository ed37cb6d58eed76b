"""A task of a thousandth of a second: learning a line, through dropout and batch statistics."""

from __future__ import annotations

import os
import signal
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from training.config import TrainingConfig
from training.run.loop import TrainingStopped, train
from training.run.records import RunFolder
from training.run.task import Network, Task

_CHANCE = np.random.default_rng(7)
ENTRIES = torch.from_numpy(_CHANCE.standard_normal((40, 3)).astype(np.float32))
VALUES = ENTRIES @ torch.tensor([[1.0], [-2.0], [0.5]])


@dataclass(frozen=True, kw_only=True)
class LineTask(ABC, Generic[Network]):
    """Learns from 32 examples; eight are held out."""

    settings: Mapping[str, Any] = field(default_factory=lambda: {"kind": "line"})
    data_sha256: str = "a" * 64
    examples: int = 32
    device: str = "cpu"
    factor: float = 1.0

    @abstractmethod
    def network(self) -> Network:
        """Return a fresh network."""

    def losses(self, network: Network, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        chosen = torch.from_numpy(rows)
        loss = nn.functional.mse_loss(network(ENTRIES[chosen]), VALUES[chosen])
        return {"loss": self.factor * loss}

    def validation(self, network: Network) -> Mapping[str, float]:
        assert not network.training
        assert not torch.is_grad_enabled()
        # What is drawn here must leave no trace in the steps that follow.
        torch.rand(5)
        return {"loss": float(nn.functional.mse_loss(network(ENTRIES[32:]), VALUES[32:]))}

    def validation_of(self, network: Network) -> Mapping[str, float]:
        """Return the held-out measures of a network."""
        with torch.no_grad():
            return self.validation(network.eval())


class Line(LineTask[nn.Sequential]):
    """Learns through dropout and batch statistics."""

    def network(self) -> nn.Sequential:
        return nn.Sequential(
            nn.Linear(3, 8), nn.BatchNorm1d(8), nn.ReLU(), nn.Dropout(0.2), nn.Linear(8, 1)
        )


def interrupt_after(*steps: int) -> Callable[[int, int, str], None]:
    """Return a listener that asks a run to stop, as Ctrl-C does, once after each of `steps`."""
    asked = set(steps)

    def show(done: int, total: int, detail: str) -> None:
        if done in asked:
            asked.remove(done)
            os.kill(os.getpid(), signal.SIGINT)

    return show


def files_of_run(
    task: Task[Network], config: TrainingConfig, folder: Path, *stops: int
) -> dict[str, bytes]:
    """Return the files of a run that was stopped after each of `stops`."""
    kept, show = RunFolder(folder), interrupt_after(*stops)
    for _ in stops:
        with pytest.raises(TrainingStopped):
            train(task, config, kept, show=show)
    train(task, config, kept, show=show)
    return {path.name: path.read_bytes() for path in (kept.checkpoint, kept.best, kept.log)}
