"""`motionjury render`."""

from __future__ import annotations

import click

from motion.errors import InputError
from studyapp.cli.arguments import cluster as cluster_option
from studyapp.cli.arguments import frames_cache as frames_cache_option
from studyapp.cli.arguments import processes as processes_option
from studyapp.cli.arguments import study_folder
from studyapp.cli.printing import counted
from studyapp.cli.progress import progress
from studyapp.stimuli.render_record import RenderProgress
from studyapp.stimuli.rendering import render
from studyapp.study.folder import StudyFolder


@click.command("render")
@study_folder
@processes_option
@cluster_option
@frames_cache_option
@click.option("--sheet", is_flag=True, help="Also write a contact sheet of every clip.")
def command(
    folder: StudyFolder,
    processes: int,
    cluster: str | None,
    frames_cache: int | None,
    sheet: bool,
) -> None:
    """Render the clips and side-by-side pairs of the study FOLDER.

    What is finished is kept: interrupted and started again, it goes on where it was.
    """
    with progress("render", "frame") as show:
        count = render(
            folder,
            processes=processes,
            cluster=cluster,
            frames_cache=frames_cache,
            on_progress=lambda now: show(now.frames, now.all_frames, _videos(now)),
        )
    for note in count.notes:
        click.secho(f"warning: {note}", fg="yellow", err=True)
    for failure in count.failures:
        click.echo(f"failed: {failure}", err=True)
    if count.left_out:
        click.echo(f"{counted(count.left_out, 'video')} made from these clips left out", err=True)
    click.echo(f"Rendered {counted(count.made, 'video')}, kept {count.kept} that still fit.")
    if sheet:
        # Imported here: it needs matplotlib's fonts, and rendering alone does not.
        from studyapp.stimuli.contact_sheet import write_contact_sheet

        with progress("sheet", "clip") as show:
            page = write_contact_sheet(folder, threads=processes, on_done=show)
        click.echo(f"The contact sheet is {page}, and as pictures beside it")
    if count.failures:
        raise InputError(
            f"{counted(len(count.failures) + count.left_out, 'video')} could not be made",
            where=folder.videos,
            remedy="Fix what is named above and run the command again",
        )


def _videos(now: RenderProgress) -> str:
    """Return the videos dealt with in words, behind the frames."""
    failed = f", {now.failed} failed" if now.failed else ""
    return f"{now.videos} of {now.all_videos} videos{failed}"
