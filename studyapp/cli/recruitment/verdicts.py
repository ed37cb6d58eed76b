"""Who is to be paid, in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import click

from studyapp.cli.printing import echo_table
from studyapp.recruitment.payment import Judged

WORDS = {"pay": "pay", "look": "decide yourself", "wait": "wait", "settled": "–"}


def echo_verdicts(heading: str, found: Sequence[tuple[str, Judged]]) -> None:
    """Print what is to be done about each, by its name, and the sums."""
    echo_table((heading, "what", "why"), [(name, WORDS[j.verdict], j.why) for name, j in found])
    sums = Counter(judged.verdict for _, judged in found)
    click.echo(
        f"{sums['pay']} to be paid, {sums['look']} to be decided by you, {sums['wait']} under way, "
        f"{sums['settled']} settled."
    )
