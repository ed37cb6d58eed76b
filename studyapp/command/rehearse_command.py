"""`motionjury rehearse`."""

from __future__ import annotations

import click

from studyapp.command.arguments import study_folder
from studyapp.command.progress import progress
from studyapp.definition.folder import StudyFolder
from studyapp.rehearsal.findings_table import findings_table
from studyapp.rehearsal.run import rehearse


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
    for line in findings_table(result.findings):
        click.echo(line)
    click.echo(
        f"{result.completed} simulated participants completed the study, {result.kept} of them "
        f"in an earlier run; {len(result.probes)} improper submissions changed nothing."
    )
