"""`motionjury render`."""

from __future__ import annotations

import click

from motion.errors import InputError
from studyapp.command.arguments import processes as processes_option
from studyapp.command.arguments import study_folder
from studyapp.command.progress import progress
from studyapp.definition.folder import StudyFolder
from studyapp.stages.rendering import render


@click.command("render")
@study_folder
@processes_option
@click.option("--sheet", is_flag=True, help="Also write a contact sheet of every clip.")
def command(folder: StudyFolder, processes: int, sheet: bool) -> None:
    """Render the clips and side-by-side pairs of the study FOLDER."""
    with progress("render", "video") as show:
        count = render(folder, processes=processes, on_done=show)
    for note in count.notes:
        click.echo(f"note: {note}")
    for failure in count.failures:
        click.echo(f"failed: {failure}", err=True)
    click.echo(f"Rendered {count.made} videos, kept {count.kept} that still fit.")
    if sheet:
        # Imported here: it needs matplotlib's fonts, and rendering alone does not.
        from studyapp.stages.contact_sheet import write_contact_sheet

        with progress("sheet", "clip") as show:
            page = write_contact_sheet(folder, threads=processes, on_done=show)
        click.echo(f"The contact sheet is {page}, and as pictures beside it")
    if count.failures:
        raise InputError(
            f"{len(count.failures)} videos could not be made",
            where=folder.videos,
            remedy="Mend what is named above and run the command again",
        )
