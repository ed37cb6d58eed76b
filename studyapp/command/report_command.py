"""`motionjury report`."""

from __future__ import annotations

import click

from studyapp.command.arguments import study_folder
from studyapp.definition.folder import StudyFolder
from studyapp.stages.reporting import report


@click.command("report")
@study_folder
def command(folder: StudyFolder) -> None:
    """Write the report of the study FOLDER: preferences and metrics, side by side."""
    click.echo(f"The report is {report(folder)}")
