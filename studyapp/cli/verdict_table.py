"""A table of who is to be paid and who is not, for the command line."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import click

from studyapp.recruitment.payment import Judged

WORDS = {"pay": "pay", "look": "decide yourself", "wait": "wait", "settled": "–"}


def echo_table(heading: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print `rows` under `heading`, in columns."""
    lines = [heading, *rows]
    widths = [max(len(line[at]) for line in lines) for at in range(len(heading))]
    for line in lines:
        cells = (cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        click.echo("  ".join(cells).rstrip())


def echo_verdicts(heading: str, found: Sequence[tuple[str, Judged]]) -> None:
    """Print what is to be done about each, by its name, and the sums."""
    echo_table((heading, "what", "why"), [(name, WORDS[j.verdict], j.why) for name, j in found])
    sums = Counter(judged.verdict for _, judged in found)
    click.echo(
        f"{sums['pay']} to be paid, {sums['look']} to be decided by you, {sums['wait']} under way, "
        f"{sums['settled']} settled."
    )
