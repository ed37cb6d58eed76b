"""Records of a run: its folder, its log, its time, and facts for files.

The log is only appended to, so that a long run saves as quickly as a short one. It is written
before the state of the run, so a crash may leave it with lost steps, which are cut off on resuming.
The durations of steps are in a separate file, because everything else of a run is reproducible.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from motion.errors import InputError

if TYPE_CHECKING:
    from training.config import TrainingConfig
    from training.run.loop import Trained


@dataclass(frozen=True)
class RunFolder:
    """The paths of a run; making one touches no disk."""

    root: Path

    @property
    def checkpoint(self) -> Path:
        """State from which the run resumes."""
        return self.root / "checkpoint.safetensors"

    @property
    def best(self) -> Path:
        """The best weights on held-out examples."""
        return self.root / "best.safetensors"

    @property
    def log(self) -> Path:
        """One JSON object a line: see `training.run.records`."""
        return self.root / "log.jsonl"

    @property
    def timing(self) -> Path:
        """One JSON object a line: how long the steps before each save took."""
        return self.root / "timing.jsonl"

    @property
    def curves(self) -> Path:
        """The log as a picture."""
        return self.root / "curves.png"


LogLine = Mapping[str, Any]
"""``step`` (steps made) and either ``learning_rate``, ``loss`` and its parts, or ``held_out``, what
was measured of held-out examples then."""


class RunLog:
    """The lines of a run, and their file.

    Parameters
    ----------
    path : Path
        One JSON object a line; need not exist for a run that begins.
    steps : int
        Steps that were made; later ones in the file are ignored.

    Raises
    ------
    InputError
        If the file lacks some of them.
    """

    def __init__(self, path: Path, *, steps: int) -> None:
        self._path = path
        self._lines: list[LogLine] = []
        self._saved_bytes = 0
        self._unsaved: list[LogLine] = []
        if path.exists():
            self._read(steps)
        logged = self.steps
        if logged != steps:
            raise InputError(
                f"the log holds {logged} of the {steps} steps that were made",
                where=path,
                remedy="Put the log back, or start again in another place",
            )

    @property
    def lines(self) -> Sequence[LogLine]:
        """All lines, in order of steps."""
        return self._lines

    @property
    def steps(self) -> int:
        """The number of steps of the lines."""
        return int(self._lines[-1]["step"]) if self._lines else 0

    @property
    def ends_in_validation(self) -> bool:
        """Whether held-out examples were measured after the last step."""
        return bool(self._lines) and "held_out" in self._lines[-1]

    @property
    def last_loss(self) -> float:
        """Loss of the last step; a step must have been made."""
        return next(float(line["loss"]) for line in reversed(self._lines) if "loss" in line)

    def add(self, line: LogLine) -> None:
        """Take one line more."""
        self._lines.append(line)
        self._unsaved.append(line)

    def save(self) -> None:
        """Append new lines to the file, and sync it to disk."""
        content = "".join(f"{json.dumps(line)}\n" for line in self._unsaved).encode()
        with self._path.open("r+b" if self._path.exists() else "xb") as file:
            # What a crash left behind the lines that count goes first.
            file.truncate(self._saved_bytes)
            file.seek(self._saved_bytes)
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        self._saved_bytes += len(content)
        self._unsaved.clear()

    def _read(self, steps: int) -> None:
        """Read the lines up to `steps`; one that a crash cut off ends them."""
        with self._path.open("rb") as file:
            for content in file:
                try:
                    line = json.loads(content)
                except ValueError:
                    return
                if not content.endswith(b"\n") or line["step"] > steps:
                    return
                self._lines.append(line)
                self._saved_bytes += len(content)


class Stopwatch:
    """Writes a line at each save.

    Parameters
    ----------
    path : Path
        One JSON object a line is appended: ``step`` (steps made in all), ``steps`` (since the line
        before, or since the run went on), ``seconds`` that they took, saving left out, ``device``
        and ``processes``.
    step : int
        Steps made until now.
    device : str
        The device.
    processes : int
        Number of processes.
    """

    def __init__(self, path: Path, *, step: int, device: str, processes: int) -> None:
        self._path = path
        self._where = {"device": device, "processes": processes}
        self._step = step
        self._began = time.monotonic()

    def stop(self, step: int) -> None:
        """Write how long the steps until `step` took; what follows is left out until `start`."""
        seconds = round(time.monotonic() - self._began, 3)
        line = {"step": step, "steps": step - self._step, "seconds": seconds, **self._where}
        with self._path.open("a", encoding="utf-8") as file:
            file.write(f"{json.dumps(line)}\n")

    def start(self, step: int) -> None:
        """Count from here."""
        self._step = step
        self._began = time.monotonic()


_PACKAGES: Final = ("motionjury", "numpy", "safetensors", "scipy", "torch")


def package_versions(*extra: str) -> dict[str, str]:
    """Return the versions of what every training uses, and of `further` packages."""
    return {name: metadata.version(name) for name in (*_PACKAGES, *extra)}


def run_facts(
    config: TrainingConfig,
    trained: Trained[Any],
    kind: str,
    data_sha256: str,
    packages: Sequence[str] = (),
) -> dict[str, Any]:
    """Return facts about a network's training and data, as JSON values.

    Parameters
    ----------
    config : TrainingConfig
        How.
    trained : Trained
        The outcome.
    kind : str
        The recordings' layout.
    data_sha256 : str
        Hash of the recordings.
    packages : sequence of str
        Further packages whose versions are recorded.
    """
    return {
        "config": config.facts(),
        "best_step": trained.best.step,
        "held_out": dict(trained.best.measured),
        "data": {"kind": kind, "sha256": data_sha256},
        "versions": package_versions(*packages),
    }
