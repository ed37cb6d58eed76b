"""Output that several commands share: progress, tables, counts."""

import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

import click
from tqdm import tqdm

from motion.errors import counted
from motion.files import write_text
from studyapp.desk.jobs import PROGRESS_FILE, Progress
from training.run.launching import is_leader

_LINE_SECONDS: Final = 30.0
"""Between two lines, without a terminal that shows a bar."""

_FILE_SECONDS: Final = 1.0


@contextmanager
def progress(title: str, unit: str) -> Iterator[Callable[..., None]]:
    """Show rate and time left: as a bar in a terminal, else as occasional lines.

    Parameters
    ----------
    title : str
        The task.
    unit : str
        What is counted, in the singular.

    Yields
    ------
    callable
        Takes (done, total) and optionally a `detail` to append. Of several processes that train
        together, only the leading one shows anything.
    """
    if not is_leader():
        yield lambda _done, _total, _detail="": None
        return
    if not sys.stderr.isatty():
        yield _Lines(title, unit).show
        return
    # After an error the bar is cleared: the error says what happened.
    with tqdm(desc=title, unit=f" {unit}", dynamic_ncols=True, mininterval=0.5, leave=False) as bar:

        def show(done: int, total: int, detail: str = "") -> None:
            bar.total = total
            # Without a step the bar would not be redrawn.
            bar.set_postfix_str(detail, refresh=done == bar.n)
            bar.update(done - bar.n)

        yield show
        bar.leave = True


@contextmanager
def sign_of_life(title: str) -> Iterator[Callable[[str], None]]:
    """Yield a function that shows the current step in a terminal; a log gets nothing."""
    with tqdm(bar_format=f"{title}: {{desc}}", leave=False, disable=None) as line:
        yield line.set_description_str


class _Lines:
    """Progress for a log: a line at most every `_LINE_SECONDS`, and one at the end.

    It is also written to the file that the environment names, for a program that watches.
    """

    def __init__(self, title: str, unit: str) -> None:
        self._title = title
        self._unit = unit
        self._printed = time.monotonic()
        self._written = -_FILE_SECONDS
        self._first: tuple[int, float] | None = None
        self._file = os.environ.get(PROGRESS_FILE)

    def show(self, done: int, total: int, detail: str = "") -> None:
        """Print a line if it is time for one."""
        now = time.monotonic()
        # Work before the first call, such as an earlier run's, does not count for the rate.
        self._first = self._first or (done, now)
        words = self._describe(done, total, detail, now, *self._first)
        if self._file and (done == total or now - self._written >= _FILE_SECONDS):
            self._written = now
            # A full disk should not end work that can do without it.
            with suppress(OSError):
                progress = Progress(done=done, total=total, words=words)
                write_text(Path(self._file), progress.model_dump_json())
        if total and (done or detail) and (done == total or now - self._printed >= _LINE_SECONDS):
            self._printed = now
            click.echo(words, err=True)

    def _describe(
        self, done: int, total: int, detail: str, now: float, first_done: int, first_time: float
    ) -> str:
        parts = [f"{self._title}: {done} of {total} {self._unit}s"]
        if done > first_done:
            rate = (done - first_done) / max(now - first_time, 1e-6)
            number = f"{rate:,.0f}" if rate >= 100 else f"{rate:.3g}"
            parts.append(f"{number} per second")
            if done < total:
                parts.append(f"about {tqdm.format_interval((total - done) / rate)} left")
        if detail:
            parts.append(detail)
        return ", ".join(parts)


_MOST_NAMED: Final = 10
"""Skipped items that are named; the others are only counted."""


def echo_table(heading: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print rows in columns under their heading."""
    lines = [heading, *rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for line in lines:
        cells = (cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        click.echo("  ".join(cells).rstrip())


def echo_note(note: str) -> None:
    """Print a note, above a progress bar if there is one."""
    if is_leader():
        tqdm.write(f"note: {note}", file=sys.stderr)


def echo_skipped(skipped: Sequence[object], unit: str) -> None:
    """Print skipped items, each with its reason, and their number."""
    for item in skipped[:_MOST_NAMED]:
        click.echo(f"skipped: {item}", err=True)
    if skipped:
        more = len(skipped) - _MOST_NAMED
        unnamed = f", {more} of them not named here" if more > 0 else ""
        click.echo(f"{counted(len(skipped), unit)} skipped{unnamed}.", err=True)
