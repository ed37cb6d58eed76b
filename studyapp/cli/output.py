"""What several commands print: how far work is, tables, counts and who is to be paid."""

from __future__ import annotations

import os
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

import click
from tqdm import tqdm

from motion.files import write_text
from studyapp.desk.jobs import PROGRESS_FILE, Progress
from studyapp.recruitment.payment import PaymentDecision
from training.run.launching import is_leader

_A_LINE_EVERY: Final = 30.0
"""Seconds between two lines where no terminal shows a bar."""

_IN_A_FILE_EVERY: Final = 1.0


@contextmanager
def progress(title: str, unit: str) -> Iterator[Callable[..., None]]:
    """Show rate and time left, as a bar or, where no terminal is, as a line now and then.

    Parameters
    ----------
    title : str
        What is being done.
    unit : str
        What is counted, in the singular.

    Yields
    ------
    callable
        Of (done, total), and optionally a `detail` to be shown behind. Where several processes
        train together, only the leading one shows anything.
    """
    if not is_leader():
        yield _show_nothing
        return
    if not sys.stderr.isatty():
        yield _Lines(title, unit).show
        return
    # A bar that an error stopped is wiped away: the error says what happened.
    with tqdm(desc=title, unit=f" {unit}", dynamic_ncols=True, mininterval=0.5, leave=False) as bar:

        def show(done: int, total: int, detail: str = "") -> None:
            bar.total = total
            # Without a step the bar would not be drawn anew.
            bar.set_postfix_str(detail, refresh=done == bar.n)
            bar.update(done - bar.n)

        yield show
        bar.leave = True


@contextmanager
def sign_of_life(title: str) -> Iterator[Callable[[str], None]]:
    """Yield what shows in a terminal what is being done, until it is done; a log gets nothing."""
    with tqdm(bar_format=f"{title}: {{desc}}", leave=False, disable=None) as line:
        yield line.set_description_str


def _show_nothing(done: int, total: int, detail: str = "") -> None:
    """Leave it to the leading process."""


class _Lines:
    """Progress for a log: a line at most every `_A_LINE_EVERY` seconds, and one at the end.

    Whoever watches the command gets it in a file besides, which the environment names.
    """

    def __init__(self, title: str, unit: str) -> None:
        self._title = title
        self._unit = unit
        self._said = time.monotonic()
        self._written = -_IN_A_FILE_EVERY
        self._first: tuple[int, float] | None = None
        self._file = os.environ.get(PROGRESS_FILE)

    def show(self, done: int, total: int, detail: str = "") -> None:
        """Write a line if it is time for one."""
        now = time.monotonic()
        # What was done before the first call, an earlier run's share or other work, is no rate.
        self._first = self._first or (done, now)
        words = self._words(done, total, detail, now, *self._first)
        if self._file and (done == total or now - self._written >= _IN_A_FILE_EVERY):
            self._written = now
            # A full disk need not end what can go on without it.
            with suppress(OSError):
                told = Progress(done=done, total=total, words=words)
                write_text(Path(self._file), told.model_dump_json())
        if (done or detail) and (done == total or now - self._said >= _A_LINE_EVERY):
            self._said = now
            click.echo(words, err=True)

    def _words(
        self, done: int, total: int, detail: str, now: float, before: int, began: float
    ) -> str:
        said = [f"{self._title}: {done} of {total} {self._unit}s"]
        if done > before:
            rate = (done - before) / max(now - began, 1e-6)
            said.append(f"{rate:.3g} a second")
            if done < total:
                said.append(f"about {tqdm.format_interval((total - done) / rate)} left")
        if detail:
            said.append(detail)
        return ", ".join(said)


_NAMED: Final = 10
"""What was skipped is named up to this many; the rest are counted."""


def echo_table(heading: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print rows under their heading, in columns as wide as needed."""
    lines = [heading, *rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for line in lines:
        cells = (cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        click.echo("  ".join(cells).rstrip())


def echo_skipped(skipped: Sequence[object], unit: str) -> None:
    """Print what could not be used, each with its reason, and how much that is."""
    for each in skipped[:_NAMED]:
        click.echo(f"skipped: {each}", err=True)
    if skipped:
        more = len(skipped) - _NAMED
        rest = f", {more} of them not named here" if more > 0 else ""
        click.echo(f"{counted(len(skipped), unit)} skipped{rest}.", err=True)


def counted(number: int, unit: str) -> str:
    """Return ``1 clip`` or ``2 clips``."""
    return f"{number} {unit}" if number == 1 else f"{number} {unit}s"


WORDS = {"pay": "pay", "look": "decide yourself", "wait": "wait", "settled": "–"}


def echo_verdicts(heading: str, found: Sequence[tuple[str, PaymentDecision]]) -> None:
    """Print what is to be done about each, by its name, and the sums."""
    echo_table((heading, "what", "why"), [(name, WORDS[j.verdict], j.reason) for name, j in found])
    sums = Counter(judged.verdict for _, judged in found)
    click.echo(
        f"{sums['pay']} to be paid, {sums['look']} to be decided by you, {sums['wait']} under way, "
        f"{sums['settled']} settled."
    )
