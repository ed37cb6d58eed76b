"""`motionjury exclude`."""

from __future__ import annotations

import click

from studyapp.command.arguments import study_folder
from studyapp.definition.folder import StudyFolder
from studyapp.stages.excluding_by_hand import decide_about


@click.command("exclude")
@study_folder
@click.argument("participant")
@click.option(
    "--reason",
    required=True,
    help="Why. It stands in the log, reports and exports: write nothing that tells who it is.",
)
@click.option("--reinstate", is_flag=True, help="Take somebody in again who was excluded so.")
def command(folder: StudyFolder, participant: str, reason: str, reinstate: bool) -> None:
    """Leave PARTICIPANT of the study FOLDER out of the analysis.

    PARTICIPANT is the number of the study session, as in reports and on researchers' pages, or the
    pseudonym of an export. Whoever is still taking part goes on and is paid; the place stays
    taken. No answer is deleted.
    """
    number = decide_about(folder, participant, excluded=not reinstate, reason=reason)
    if reinstate:
        click.echo(
            f"Study session {number} is no longer excluded by hand. The exclusion rules of the "
            "study file hold as before. Report and export again."
        )
        return
    click.echo(
        f"Study session {number} is left out of the analysis, which reports mark as exploratory. "
        "Report and export again. --reinstate takes it back."
    )
