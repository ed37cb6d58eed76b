"""The folder of one training run: its state, its best weights, its log and its curves."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from motion.files import write_text

LogLine = Mapping[str, Any]


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
        """One JSON object a line: the losses of each step, and what was measured after it."""
        return self.root / "log.jsonl"

    @property
    def curves(self) -> Path:
        """The log as a picture."""
        return self.root / "curves.png"

    def read_log(self, steps: int) -> list[LogLine]:
        """Return the log of the first `steps` steps; a line that a crash cut off ends it."""
        lines: list[LogLine] = []
        if not self.log.exists():
            return lines
        for text in self.log.read_text(encoding="utf-8").splitlines():
            try:
                line = json.loads(text)
            except ValueError:
                break
            if line["step"] > steps:
                break
            lines.append(line)
        return lines

    def write_log(self, lines: list[LogLine]) -> None:
        """Write the whole log, in one step."""
        write_text(self.log, "".join(f"{json.dumps(line)}\n" for line in lines))
