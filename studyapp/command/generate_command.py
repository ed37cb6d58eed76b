"""`motionjury generate`."""

from __future__ import annotations

import click

from studyapp.command.arguments import study_folder
from studyapp.command.progress import progress
from studyapp.definition.folder import StudyFolder
from studyapp.stages.generation import generate


@click.command("generate")
@study_folder
def command(folder: StudyFolder) -> None:
    """Make the motion of every generated condition of the study FOLDER."""
    with progress("generate", "clip") as show:
        count = generate(folder, on_clip=show)
    click.echo(f"Generated {count.made} clips, kept {count.kept} that still fit.")
