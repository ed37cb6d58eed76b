"""One cell of a plan: a study of one size and a difference of one size."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

import numpy as np
from threadpoolctl import threadpool_limits

from analysis.planning.part import Opinions, Part, Size
from analysis.planning.power import Effort, Power, power_of
from motion.files import write_text

VERSION: Final = "2"
"""Raised whenever the same task is simulated otherwise."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """How often a study of one size finds a difference of one size.

    Attributes
    ----------
    participants, items, recruited, analysed, trials : int
        See `analysis.planning.part.Size`.
    powers : tuple of Power
        Of each part of the study.
    """

    participants: int
    items: int
    recruited: int
    analysed: int
    trials: int
    powers: tuple[Power, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """A cell that is to be simulated.

    Attributes
    ----------
    size : Size
        The study.
    effect : float
        By how much one condition is better than all others, in logits.
    opinions : Opinions
        How people answer.
    effort : Effort
        How much is simulated.
    seed : int
        The same seed gives the same numbers, whatever other cells a plan has.
    """

    size: Size
    effect: float
    opinions: Opinions
    effort: Effort
    seed: int

    @property
    def seconds(self) -> float:
        """About how long it takes, in seconds of one processor."""
        return sum(
            _seconds(part, self.effort, with_null=self.effect > 0) for part in self.size.parts
        )

    @property
    def key(self) -> str:
        """A hash of everything that the numbers depend on, the code included."""
        digest = hashlib.sha256(VERSION.encode())
        settings = [self.effect, asdict(self.opinions), asdict(self.effort), self.seed]
        digest.update(json.dumps(settings).encode())
        for part in self.size.parts:
            trials = part.trials
            words = (part.name, part.kind, part.levels, part.blocks, part.family, part.test)
            digest.update(json.dumps([*words, trials.conditions]).encode())
            for codes in (trials.participants, trials.items, trials.left, trials.right):
                digest.update(b"-" if codes is None else np.asarray(codes, "<i8").tobytes())
        return digest.hexdigest()[:32]

    def done(self, powers: Sequence[Power]) -> Cell:
        """Return the cell with its numbers."""
        size = self.size
        return Cell(
            participants=size.participants,
            items=size.items,
            recruited=size.recruited,
            analysed=size.analysed,
            trials=size.trials,
            powers=tuple(powers),
        )


def simulated(task: Task) -> Cell:
    """Simulate a cell."""
    # The same noise for every effect: powers rise smoothly with it.
    seed = (task.seed, task.size.participants, task.size.items)
    # Small matrices: threads of the linear algebra would only wait for one another.
    with threadpool_limits(limits=1, user_api="blas"):
        powers = power_of(task.size.parts, task.opinions, task.effect, task.effort, seed)
    return task.done(powers)


def kept_cell(task: Task, folder: Path) -> Cell | None:
    """Return what was simulated before; None where nothing was, or it cannot be read."""
    try:
        rows = json.loads((folder / f"{task.key}.json").read_text("utf-8"))
        return task.done([Power(**row) for row in rows])
    except (OSError, ValueError, TypeError):
        return None


def keep_cell(task: Task, cell: Cell, folder: Path) -> None:
    """Keep what was simulated for a later run."""
    rows = [asdict(power) for power in cell.powers]
    write_text(folder / f"{task.key}.json", json.dumps(rows))


def _seconds(part: Part, effort: Effort, *, with_null: bool) -> float:
    answers = len(part.trials.participants) * (
        1 if part.kind == "pairs" else part.trials.conditions
    )
    quick = 2.5e-7 * answers * effort.quick * (2 if with_null else 1)
    if part.kind == "ratings" or part.test == "crossed_lmm":
        return quick
    tests = len(part.trials.pairs) if part.kind == "pairs" else 1
    each = (0.018 if part.kind == "pairs" else 0.006) * tests + 6e-6 * answers
    return quick + each * min(effort.exact, USUAL)


USUAL: Final = 90
"""Models that are usually fitted until a power is precise enough."""
