"""`motionjury export`."""

from __future__ import annotations

from pathlib import Path

import click

from studyapp.command.arguments import study_folder
from studyapp.definition.folder import StudyFolder
from studyapp.stages.answers import export


@click.command("export")
@study_folder
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Where to write; responses.csv in the study folder by default.",
)
@click.option("--rehearsal", is_flag=True, help="Export the simulated participants instead.")
@click.option(
    "--withdrawn",
    is_flag=True,
    help="Export what was kept of participants who withdrew instead; it is never analysed.",
)
def command(folder: StudyFolder, out: Path | None, rehearsal: bool, withdrawn: bool) -> None:
    """Write the responses of the study FOLDER as tidy CSV, one row per answered question.

    Tables beside it hold what participants said about themselves (_form), how each video was
    watched (_watching) and which requests were refused (_refusals).
    """
    kinds = ("rehearsal_" if rehearsal else "") + ("withdrawn_" if withdrawn else "")
    path = out or folder.root / f"{kinds}responses.csv"
    count = export(folder, path, rehearsal=rehearsal, withdrawn=withdrawn)
    click.echo(f"Wrote {count} answers to {path}")
    if not (count or rehearsal or withdrawn) and folder.rehearsal.exists():
        click.echo("Nobody has answered yet; --rehearsal exports the simulated participants.")
