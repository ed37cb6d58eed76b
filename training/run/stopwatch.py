"""How long training takes, in a file of its own: all else of a run comes out the same again."""

from __future__ import annotations

import json
import time
from pathlib import Path


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
        Where it is computed.
    processes : int
        How many train together.
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
