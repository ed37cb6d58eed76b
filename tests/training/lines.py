"""Learning a line, which takes a thousandth of a second, in this process or in one of several.

As a program, for each training: the run folder, a JSON object of changed settings, and the step
after which to stop.
"""

import atexit
import json
import os
import signal
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from torch import Tensor, nn

from motion.arrays import Ints
from motion.errors import InputError
from training.config import Decay, TrainingConfig
from training.run.loop import TrainingStopped, train
from training.run.records import RunFolder
from training.run.task import Network, Task

_CHANCE = np.random.default_rng(7)
ENTRIES = torch.from_numpy(_CHANCE.standard_normal((40, 3)).astype(np.float32))
VALUES = ENTRIES @ torch.tensor([[1.0], [-2.0], [0.5]])

CONFIG = TrainingConfig(
    steps=8,
    batch_size=14,
    learning_rate=0.02,
    accumulate=4,
    decay=Decay(factor=0.5),
    gradient_clip=0.5,
    weight_decay=0.1,
    ema_decay=0.9,
    validate_every=3,
)


class LineNetwork(nn.Module):
    """Layers that all examples pass, one that only the first example passes, and an idle one."""

    def __init__(self, dropout: float, *, normed: bool = False) -> None:
        super().__init__()
        norms = [nn.BatchNorm1d(8) if normed else nn.Identity() for _ in range(2)]
        self.common = nn.Sequential(
            # Before a layer that takes the mean off, a bias would move by rounding alone.
            nn.Linear(3, 8, bias=not normed),
            *(norms[0], nn.Tanh(), nn.Dropout(dropout)),
            *(nn.Linear(8, 8, bias=False), norms[1], nn.Tanh()) if normed else (),
            nn.Linear(8, 1),
        )
        self.rare = nn.Linear(3, 1)
        self.idle = nn.Linear(3, 1)

    def forward(self, entries: Tensor, first: Tensor | None = None) -> Tensor:
        result: Tensor = self.common(entries)
        if first is not None and first.any():
            result = result + first[:, None] * self.rare(entries)
        return result


@dataclass(frozen=True, kw_only=True)
class Line:
    """Learns from 32 examples, through dropout and noise or without; eight are held out."""

    chance: bool = True
    normed: bool = False
    settings: Mapping[str, Any] = field(default_factory=lambda: {"kind": "line"})
    data_sha256: str = "a" * 64
    examples: int = 32
    device: str = "cpu"
    factor: float = 1.0

    def network(self) -> LineNetwork:
        return LineNetwork(dropout=0.2 if self.chance else 0.0, normed=self.normed)

    def losses(self, network: LineNetwork, rows: Ints, name: str = "") -> Mapping[str, Tensor]:
        chosen = torch.from_numpy(rows)
        entries = ENTRIES[chosen]
        if self.chance:
            entries = entries + 0.3 * torch.randn(len(rows), 3)
        result = network(entries, chosen == 0)
        loss = nn.functional.mse_loss(result, VALUES[chosen])
        return {"loss": self.factor * loss, "size": result.abs().mean()}

    def validation(self, network: LineNetwork) -> Mapping[str, float]:
        assert not network.training
        assert not torch.is_grad_enabled()
        # What is drawn here must leave no trace in the steps that follow.
        torch.rand(5)
        return {"loss": float(nn.functional.mse_loss(network(ENTRIES[32:]), VALUES[32:]))}


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


def learn(folder: Path, changed: dict[str, Any], stop: int) -> None:
    """Train in `folder`, and have the leading process stopped after `stop` steps."""
    task = Line(normed=changed.pop("normed", False))
    usual = {name: getattr(CONFIG, name) for name in CONFIG.facts()}
    config = TrainingConfig(**{**usual, **changed})
    train(task, config, RunFolder(folder), show=interrupt_after(stop))


def leave_alone() -> None:
    """Fail where a thread still serves the group: after Python's end it may break the process."""
    threads = {path.read_text().strip() for path in Path("/proc/self/task").glob("*/comm")}
    if threads & {"pt_gloo_runloop", "gloo_tcp_loop"}:
        os._exit(70)


if __name__ == "__main__":
    atexit.register(leave_alone)
    try:
        for folder, changed, stop in zip(*[iter(sys.argv[1:])] * 3, strict=True):
            try:
                learn(Path(folder), json.loads(changed), int(stop))
            except TrainingStopped as stopped:
                Path(folder, f"stopped at {stopped.step}").touch()
    except InputError as error:
        sys.exit(str(error))
