"""The table that shows what was put into a rehearsal beside what its answers say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Final

from studyapp.rehearsal.findings import Finding, Findings
from studyapp.rehearsal.record import Measure

MEASURES: Final[Mapping[Measure, str]] = MappingProxyType(
    {
        "win_share": "wins of the first",
        "own_speech": "own speech preferred",
        "mean_rating": "mean rating",
        "mean_rank": "mean rank",
    }
)
"""What each measure is called in the table."""

HEADINGS: Final = ("part", "question", "measured", "about", "put in", "found", "answers")


def findings_table(findings: Findings) -> Iterator[str]:
    """Yield the table's lines, above them one that says what they show; none without answers."""
    if not findings.rows:
        return
    yield " ".join(_explained(findings))
    rows = [HEADINGS, *(_cells(row) for row in findings.rows)]
    used = [column for column, cells in enumerate(zip(*rows[1:], strict=True)) if any(cells)]
    widths = {column: max(len(row[column]) for row in rows) for column in used}
    for row in rows:
        yield "  ".join(
            row[column].rjust(widths[column])
            if column >= HEADINGS.index("put in")
            else row[column].ljust(widths[column])
            for column in used
        )


def _explained(findings: Findings) -> Iterator[str]:
    """Yield the sentences that say what the numbers are."""
    yield (
        "Put in: what very many attentive raters would say of these segments; found: plain means "
        "of the analysed answers, "
        f"{findings.excluded or 'no'} participant{'' if findings.excluded == 1 else 's'} excluded "
        "by the study's rules."
    )
    if any(row.measure in ("win_share", "own_speech") for row in findings.rows):
        yield "'No difference' is half a win."
    if any(row.put_in is None for row in findings.rows):
        yield "–: not computed, since motions may share a rank."


def _cells(row: Finding) -> tuple[str, ...]:
    return (
        row.part,
        row.question,
        MEASURES[row.measure],
        row.about,
        "–" if row.put_in is None else f"{row.put_in:.2f}",
        f"{row.found:.2f}",
        str(row.answers),
    )
