"""What came of a rehearsal, in the lines that a command prints."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

from analysis.results.known_values import Found
from studyapp.stages.recovery.recovering import Recovery
from studyapp.stages.recovery.words import summary

HEADINGS: Final = ("question", "of", "number", "put in", "found", "interval", "")
FIRST_NUMBER: Final = 3


def recovery_lines(recovery: Recovery) -> Iterator[str]:
    """Yield a table of what was put in and found, and sentences about all else."""
    rows = [
        (
            f"{known.part}: {known.question}" if known.part else known.question,
            known.about,
            known.measure.replace("_", " "),
            f"{known.value:.2f}",
            "–" if math.isnan(found.estimate) else f"{found.estimate:.2f}",
            f"{found.low:.2f} to {found.high:.2f}" if found.has_interval else "–",
            _where(found, known.value),
        )
        for known, found in recovery.values
    ]
    if rows:
        yield from _in_columns([HEADINGS, *rows])
    yield from summary(recovery)


def _where(found: Found, value: float) -> str:
    if not found.has_interval:
        return found.reason
    return "" if found.covers(value) else "outside"


def _in_columns(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  ".join(
            text.rjust(width) if FIRST_NUMBER <= place < len(row) - 1 else text.ljust(width)
            for place, (text, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
