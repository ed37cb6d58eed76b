"""The cells of a plan, each a study of one size: simulated by several processes, and kept."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from threadpoolctl import threadpool_limits

from analysis.planning.part import Opinions, Part, Size
from analysis.planning.power import FEWEST_EXACT, Effort, Power, simulate_power
from motion.files import write_text
from motion.processes import ProcessPool

VERSION: Final = "3"
"""Raised whenever the same task would give other numbers."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """The power of a study of one size for one effect.

    Attributes
    ----------
    size : Size
        The study.
    powers : tuple of Power
        The power of each part of the study.
    """

    size: Size
    powers: tuple[Power, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """A cell to simulate.

    Attributes
    ----------
    size : Size
        The study.
    effect : float
        How much better one condition is than all others, in logits.
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
        """Estimated time, in seconds of one processor."""
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
            words = (part.name, part.kind, part.levels, part.blocks, part.family)
            digest.update(json.dumps([*words, trials.conditions]).encode())
            for codes in (trials.participants, trials.items, trials.left, trials.right):
                digest.update(b"-" if codes is None else np.asarray(codes, "<i8").tobytes())
        return digest.hexdigest()[:32]


def simulate_cell(task: Task) -> tuple[Power, ...]:
    """Return the powers of a cell's parts."""
    # The same noise for every effect: powers rise smoothly with it.
    seed = (task.seed, *task.size.numbers)
    # Small matrices: threads of the linear algebra would only wait for one another.
    with threadpool_limits(limits=1, user_api="blas"):
        return simulate_power(task.size.parts, task.opinions, task.effect, task.effort, seed)


def load_powers(task: Task, folder: Path) -> tuple[Power, ...] | None:
    """Return the powers kept by an earlier run; None if there are none, or they are unreadable."""
    try:
        rows = json.loads((folder / f"{task.key}.json").read_text("utf-8"))
        return tuple(Power(**row) for row in rows)
    except (OSError, ValueError, TypeError):
        return None


def _seconds(part: Part, effort: Effort, *, with_null: bool) -> float:
    answers = len(part.trials.participants) * (
        1 if part.kind == "pairs" else part.trials.conditions
    )
    quick = 2.5e-7 * answers * effort.quick * (2 if with_null else 1)
    if part.kind == "ratings":
        return quick
    if part.kind == "pairs":
        each = 0.018 * len(part.trials.pairs) + 1e-5 * answers
    else:
        each = 0.006 + 6e-6 * answers
    return quick + each * min(effort.exact, USUAL)


USUAL: Final = 90
"""Number of models that are usually fitted until a power is precise enough."""


Show = Callable[[int, int], None]
"""Called with the number of finished cells, and of all cells."""

PROCESSORS: Final = 2
"""Number of processors for which minutes are estimated."""

FEWEST_QUICK: Final = 400
"""Fewest blocks for the quick tests."""

SHORT: Final = 4.0
"""Seconds of work below which starting processes does not pay."""


@dataclass(frozen=True, kw_only=True)
class Runner:
    """How cells are simulated.

    Attributes
    ----------
    folder : Path
        Where simulated cells are kept.
    processes : int
        Number of processes; the results do not depend on it.
    show : callable, optional
        Called with the number of finished cells, and of all cells.
    """

    folder: Path
    processes: int = 1
    show: Show | None = None

    def cells(self, tasks: Sequence[Task]) -> list[Cell]:
        """Return the cell of each task, in order; an interrupted run is resumed."""
        loaded = {number: load_powers(task, self.folder) for number, task in enumerate(tasks)}
        powers_of = {number: powers for number, powers in loaded.items() if powers is not None}
        waiting = [number for number in range(len(tasks)) if number not in powers_of]
        self._show_progress(len(powers_of), len(tasks))
        for number, powers in self._simulated(tasks, waiting):
            kept = json.dumps([asdict(power) for power in powers])
            write_text(self.folder / f"{tasks[number].key}.json", kept)
            powers_of[number] = powers
            self._show_progress(len(powers_of), len(tasks))
        return [Cell(size=task.size, powers=powers_of[n]) for n, task in enumerate(tasks)]

    def _show_progress(self, done: int, total: int) -> None:
        if self.show is not None:
            self.show(done, total)

    def _simulated(
        self, tasks: Sequence[Task], waiting: Sequence[int]
    ) -> Iterator[tuple[int, tuple[Power, ...]]]:
        work = sum(tasks[number].seconds for number in waiting)
        if min(self.processes, len(waiting)) < 2 or work < SHORT:
            for number in waiting:
                yield number, simulate_cell(tasks[number])
            return
        # The longest first, so that no process is left with one at the end.
        order = sorted(waiting, key=lambda number: -tasks[number].seconds)
        with ProcessPool(min(self.processes, len(waiting))) as pool:
            running = {pool.submit(simulate_cell, tasks[number]): number for number in order}
            for future in as_completed(running):
                yield running[future], future.result()


def limit_effort(tasks: Sequence[Task], minutes: float) -> list[Task]:
    """Return the tasks, with less effort if they would take longer than `minutes`.

    The estimate is for two processors. It depends on the studies alone, so the results do not
    depend on a machine's speed.
    """
    whole = sum(task.seconds for task in tasks)
    share = 60 * minutes * PROCESSORS / max(whole, 1e-9)
    if share >= 1:
        return list(tasks)
    return [replace(task, effort=_reduced(task.effort, share)) for task in tasks]


def estimate_minutes(tasks: Sequence[Task]) -> float:
    """Return the estimated minutes of the tasks on two processors."""
    return sum(task.seconds for task in tasks) / 60 / PROCESSORS


def _reduced(effort: Effort, share: float) -> Effort:
    return replace(
        effort,
        quick=max(min(FEWEST_QUICK, effort.quick), int(effort.quick * share)),
        exact=max(FEWEST_EXACT, int(min(effort.exact, USUAL) * share)),
    )
