"""The folder of one training run: its state, its best weights, its log and its curves."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class RunFolder:
    """The paths of a run; making one touches no disk."""

    root: Path

    @property
    def checkpoint(self) -> Path:
        """State from which the run goes on."""
        return self.root / "checkpoint.safetensors"

    @property
    def best(self) -> Path:
        """Weights that did best on held-out examples."""
        return self.root / "best.safetensors"

    @property
    def log(self) -> Path:
        """One JSON object a line: see `training.run.log`."""
        return self.root / "log.jsonl"

    @property
    def timing(self) -> Path:
        """One JSON object a line: how long the steps before each save took."""
        return self.root / "timing.jsonl"

    @property
    def curves(self) -> Path:
        """The log as a picture."""
        return self.root / "curves.png"
