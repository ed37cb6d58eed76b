"""How long work shows how far it is."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

import click
from tqdm import tqdm

from training.run.launching import is_leader

_A_LINE_EVERY: Final = 30.0
"""Seconds between two lines where no terminal shows a bar."""


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


def _show_nothing(done: int, total: int, detail: str = "") -> None:
    """Leave it to the leading process."""


class _Lines:
    """Progress for a log: a line at most every `_A_LINE_EVERY` seconds, and one at the end."""

    def __init__(self, title: str, unit: str) -> None:
        self._title = title
        self._unit = unit
        self._said = time.monotonic()
        self._first: tuple[int, float] | None = None

    def show(self, done: int, total: int, detail: str = "") -> None:
        """Write a line if it is time for one."""
        now = time.monotonic()
        # What was done before the first call, an earlier run's share or other work, is no rate.
        self._first = self._first or (done, now)
        if not (done or detail) or (done < total and now - self._said < _A_LINE_EVERY):
            return
        self._said = now
        said = [f"{self._title}: {done} of {total} {self._unit}s"]
        before, began = self._first
        if done > before:
            rate = (done - before) / max(now - began, 1e-6)
            said.append(f"{rate:.3g} a second")
            if done < total:
                said.append(f"about {tqdm.format_interval((total - done) / rate)} left")
        if detail:
            said.append(detail)
        click.echo(", ".join(said), err=True)
