"""`motionjury rehearse`."""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType
from typing import Final

import click

from studyapp.command.arguments import study_folder
from studyapp.command.progress import progress
from studyapp.definition.folder import StudyFolder
from studyapp.rehearsal.findings import Finding, Findings
from studyapp.rehearsal.run import rehearse

MEASURES: Final = MappingProxyType(
    {
        "win_share": "wins of the first",
        "own_speech": "own speech preferred",
        "mean_rating": "mean rating",
        "mean_rank": "mean rank",
    }
)
"""What each measure is called in the table."""

HEADINGS: Final = ("part", "question", "measured", "about", "put in", "found", "answers")


@click.command("rehearse")
@study_folder
@click.option(
    "--participants",
    type=click.IntRange(1, 10_000),
    help="Simulated participants, of each comparison where each has its own; as many as the "
    "study asks for by default.",
)
@click.option("--seed", type=click.IntRange(0, 2**32 - 1), default=1, show_default=True)
def command(folder: StudyFolder, participants: int | None, seed: int) -> None:
    """Let simulated participants take the study FOLDER over real HTTP."""
    with progress("rehearse", "participant") as show:
        result = rehearse(folder, participants=participants, seed=seed, on_done=show)
    if result.note:
        click.echo(f"note: {result.note}")
    for line in _table(result.findings):
        click.echo(line)
    click.echo(
        f"{result.completed} simulated participants completed the study, {result.kept} of them "
        f"in an earlier run; {len(result.probes)} improper submissions changed nothing."
    )


def _table(findings: Findings) -> Iterator[str]:
    """Yield the lines that show what was put in beside what was found."""
    if not findings.rows:
        return
    yield (
        "Put in: what very many attentive raters would say of these segments; found: plain means "
        "of the analysed answers, "
        f"{findings.excluded or 'no'} participant{'' if findings.excluded == 1 else 's'} excluded "
        "by the study's rules. Ties are half a win."
    )
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
