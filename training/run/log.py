"""The log of a run: what each step lost, and what was measured after it.

The file grows by what is new, so that a long run saves as quickly as a short one. It is written
before the state of the run is, and may tell of steps that a crash then lost: whoever goes on cuts
them off.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from motion.errors import InputError

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
        Steps that were made; what the file tells of later ones is left out.

    Raises
    ------
    InputError
        If the file does not tell of all of them.
    """

    def __init__(self, path: Path, *, steps: int) -> None:
        self._path = path
        self._lines: list[LogLine] = []
        self._kept = 0
        self._fresh: list[LogLine] = []
        if path.exists():
            self._read(steps)
        known = self.steps
        if known != steps:
            raise InputError(
                f"the log tells of {known} of the {steps} steps that were made",
                where=path,
                remedy="Put the log back, or begin anew in another place",
            )

    @property
    def lines(self) -> Sequence[LogLine]:
        """All lines, in order of steps."""
        return self._lines

    @property
    def steps(self) -> int:
        """How many steps the lines tell of."""
        return int(self._lines[-1]["step"]) if self._lines else 0

    @property
    def measured(self) -> bool:
        """Whether held-out examples were looked at after the last step."""
        return bool(self._lines) and "held_out" in self._lines[-1]

    @property
    def last_loss(self) -> float:
        """Loss of the last step; a step must have been made."""
        return next(float(line["loss"]) for line in reversed(self._lines) if "loss" in line)

    def add(self, line: LogLine) -> None:
        """Take one line more."""
        self._lines.append(line)
        self._fresh.append(line)

    def save(self) -> None:
        """Append what is new to the file, and see it onto the disk."""
        content = "".join(f"{json.dumps(line)}\n" for line in self._fresh).encode()
        with self._path.open("r+b" if self._path.exists() else "xb") as file:
            # What a crash left behind the lines that count goes first.
            file.truncate(self._kept)
            file.seek(self._kept)
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        self._kept += len(content)
        self._fresh.clear()

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
                self._kept += len(content)
