"""Tables and counts that several commands print."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import click

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
