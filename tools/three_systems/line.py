"""Running commands in order, each once, and recording their times."""

import json
import resource
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from motion.errors import InputError
from motion.files import write_text

_KEPT: Final = "times.json"


@dataclass(frozen=True, kw_only=True)
class Took:
    """The time of a step, over all its runs.

    Attributes
    ----------
    seconds : float
        Wall-clock time.
    processor : float
        Processor time of all its processes.
    """

    seconds: float
    processor: float


@dataclass(frozen=True)
class Line:
    """Steps in a folder.

    Attributes
    ----------
    folder : Path
        Folder in which they run and their times are recorded.
    """

    folder: Path

    def run(self, *words: str, of: str = "") -> None:
        """Run ``motionjury`` with `words` unless that was done already.

        Parameters
        ----------
        *words : str
            The command and its arguments.
        of : str
            What it depends on besides its words; a change makes it run again.

        Raises
        ------
        InputError
            If it fails.
        """
        command = [str(Path(sys.executable).with_name("motionjury")), *words]
        with self.step(" ".join(["motionjury", *words]), of=of) as is_due:
            if not is_due:
                return
            done = subprocess.run(command, cwd=self.folder, check=False)  # noqa: S603
            if done.returncode:
                raise InputError(
                    f"'motionjury {' '.join(words)}' failed",
                    where=self.folder,
                    remedy="Repair what it reports, and run this again: it continues from there",
                )

    @contextmanager
    def step(self, name: str, *, of: str = "") -> Iterator[bool]:
        """Yield whether a step has to run, and record its time; see `run`."""
        record = self._kept()
        known = record.get(name, {})
        is_due = known.get("done_of") != of
        if not is_due:
            yield False
            return
        print(f"— {name}", flush=True)
        clock, processor = time.perf_counter(), _processor_seconds()
        done_of = None
        try:
            yield True
            done_of = of
        finally:
            same = known.get("of") == of
            record = self._kept()
            record[name] = {
                "of": of,
                "done_of": done_of,
                "seconds": time.perf_counter() - clock + (known["seconds"] if same else 0),
                "processor": _processor_seconds() - processor + (known["processor"] if same else 0),
            }
            write_text(self.folder / _KEPT, json.dumps(record, indent=1) + "\n")

    def took(self) -> dict[str, Took]:
        """Return the time of each step, in the order of their first runs."""
        return {
            name: Took(seconds=entry["seconds"], processor=entry["processor"])
            for name, entry in self._kept().items()
        }

    def _kept(self) -> dict[str, Any]:
        path = self.folder / _KEPT
        record: dict[str, Any] = json.loads(path.read_text("utf-8")) if path.exists() else {}
        return record


def _processor_seconds() -> float:
    """Return the processor time of this process and its finished children."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(entry.ru_utime + entry.ru_stime for entry in used)


def places(paths: Sequence[Path], folder: Path) -> list[str]:
    """Return the paths relative to `folder` if they are in it."""
    return [
        str(path.relative_to(folder) if path.is_relative_to(folder) else path) for path in paths
    ]
