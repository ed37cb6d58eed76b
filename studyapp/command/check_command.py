"""`motionjury check`."""

from __future__ import annotations

import click

from motion.errors import InputError
from studyapp.command.arguments import study_folder
from studyapp.definition.folder import StudyFolder
from studyapp.stages.finding import Severity
from studyapp.stages.preflight import check


@click.command("check")
@study_folder
def command(folder: StudyFolder) -> None:
    """Say everything that can go wrong before the study FOLDER is launched."""
    findings = check(folder)
    for finding in findings:
        remedy = f" {finding.remedy}." if finding.remedy else ""
        click.echo(f"{finding.severity.value + ':':9}{finding.what}.{remedy}")
    errors = sum(finding.severity is Severity.ERROR for finding in findings)
    if errors:
        things = "1 thing" if errors == 1 else f"{errors} things"
        raise InputError(
            f"{things} must be mended before participants can take part", where=folder.root
        )
    click.echo(f"{folder.root} can be served.")
