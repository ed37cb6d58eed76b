"""What simulated participants know for certain: the answers that the server has acknowledged."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock
from typing import Any

from studyapp.study.design.asking import Answers

AnswerPlace = tuple[str, str, int]
"""Token of the trial, question, and number of the stimulus (0 for the trial)."""


@dataclass(frozen=True, kw_only=True)
class Acknowledged:
    """All that participants were told is stored.

    Attributes
    ----------
    answers : dict of AnswerPlace to int
        Values.
    codes : dict of str to str
        The completion code of each participant who has one.
    left, returned : Counter of str
        How often each participant left to come back, and came back.
    """

    answers: dict[AnswerPlace, int] = field(default_factory=dict)
    codes: dict[str, str] = field(default_factory=dict)
    left: Counter[str] = field(default_factory=Counter)
    returned: Counter[str] = field(default_factory=Counter)

    @property
    def away(self) -> frozenset[str]:
        """Who has left to come back, and may have come back since."""
        return frozenset(self.left)


@dataclass(frozen=True)
class Ledger:
    """A file with a line for each thing that a participant was told, as soon as it was told.

    It outlives a rehearsal that is stopped anywhere; of what the server did, it holds nothing that
    no participant was told.
    """

    path: Path
    lock: Lock = field(default_factory=Lock, repr=False)

    def answered(self, name: str, trial: str, values: Answers) -> None:
        """Note that the answers to the trial with the token `trial` were taken."""
        said = [[question, stimulus or 0, v] for (question, stimulus), v in values.items()]
        self._add({"participant": name, "trial": trial, "answers": said})

    def completed(self, name: str, code: str) -> None:
        """Note that a participant was shown the completion code."""
        self._add({"participant": name, "code": code})

    def left(self, name: str) -> None:
        """Note that a participant left to come back."""
        self._add({"participant": name, "left": True})

    def returned(self, name: str) -> None:
        """Note that a participant came back."""
        self._add({"participant": name, "returned": True})

    def read(self) -> Acknowledged:
        """Return all that was noted."""
        found = Acknowledged()
        for line in self._lines():
            name = line["participant"]
            for question, stimulus, value in line.get("answers", ()):
                found.answers[line["trial"], question, stimulus] = value
            if "code" in line:
                found.codes[name] = line["code"]
            found.left.update([name] * ("left" in line))
            found.returned.update([name] * ("returned" in line))
        return found

    def remove(self) -> None:
        """Forget everything."""
        self.path.unlink(missing_ok=True)

    def _add(self, line: dict[str, Any]) -> None:
        with self.lock:
            self.path.parent.mkdir(exist_ok=True)
            with self.path.open("a+b") as file:
                # What a run that was killed has left unfinished stays a line of its own.
                if file.tell() and not self._ends_whole():
                    file.write(b"\n")
                file.write(json.dumps(line).encode() + b"\n")

    def _ends_whole(self) -> bool:
        with self.path.open("rb") as file:
            file.seek(-1, 2)
            return file.read(1) == b"\n"

    def _lines(self) -> Iterator[dict[str, Any]]:
        """Yield all lines but those that were never finished."""
        if not self.path.exists():
            return
        for text in self.path.read_text("utf-8", errors="replace").splitlines():
            try:
                line = json.loads(text)
            except json.JSONDecodeError:
                continue
            if isinstance(line, dict) and "participant" in line:
                yield line
