"""`motionjury render` and `motionjury preview`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from motion.errors import InputError
from motion.formats.joint_maps import JointMap
from renderer.look import AVATARS, FIRST_AVATAR, FRAMINGS, VIEWS, Look
from studyapp.cli.arguments import cluster as cluster_option
from studyapp.cli.arguments import joints_option, study_folder
from studyapp.cli.arguments import processes as processes_option
from studyapp.cli.output import counted, progress
from studyapp.study.folder import StudyFolder

if TYPE_CHECKING:
    from studyapp.stimuli.render_record import RenderProgress


@click.command("render")
@study_folder
@processes_option
@cluster_option
@click.option("--sheet", is_flag=True, help="Also write a contact sheet of every clip.")
def command(
    folder: StudyFolder,
    processes: int,
    cluster: str | None,
    sheet: bool,
) -> None:
    """Render the clips and side-by-side pairs of the study FOLDER.

    What is finished is kept: interrupted and started again, it goes on where it was.
    """
    # Imported here: drawing takes a second to load, and a wrong option should be told at once.
    from studyapp.stimuli.rendering import render

    with progress("render", "frame") as show:
        count = render(
            folder,
            processes=processes,
            cluster=cluster,
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
        from studyapp.stimuli.figures.contact_sheet import write_contact_sheet

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


_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@click.command("preview")
@click.argument("motions", nargs=-1, required=True, type=_FILE, metavar="FILE...")
@click.option("--speech", type=_FILE, help="What is heard.")
@click.option("--fps", type=click.FloatRange(0, 1000, min_open=True), help="True frame rate.")
@joints_option
@click.option("--avatar", type=click.Choice(list(AVATARS)), default=FIRST_AVATAR, show_default=True)
@click.option(
    "--framing", type=click.Choice(list(FRAMINGS)), default="full_body", show_default=True
)
@click.option("--view", type=click.Choice(list(VIEWS)), default="front", show_default=True)
@click.option(
    "--size",
    type=click.IntRange(64, 2160),
    default=720,
    show_default=True,
    help="Pixels along each side of a video.",
)
@click.option(
    "--as",
    "kinds",
    type=click.Choice(["page", "video", "glb", "bvh"]),
    multiple=True,
    default=["page"],
    show_default=True,
    help="What to write, as often as wanted: one page on which the motions play side by side and "
    "can be turned around, a video of each, or each for other programs.",
)
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("preview"),
    show_default=True,
    help="The folder to write into.",
)
def preview_command(
    motions: tuple[Path, ...],
    speech: Path | None,
    fps: float | None,
    joint_map: JointMap | None,
    avatar: str,
    framing: str,
    view: str,
    size: int,
    kinds: tuple[str, ...],
    out: Path,
) -> None:
    """Show each motion FILE in three dimensions, as a video, GLB or BVH; no study is needed."""
    # Imported here: drawing takes a second to load, and a wrong option should be told at once.
    from studyapp.stimuli.figures.motion_preview import (
        PAGE,
        distinct_names,
        read_previewed,
        write_preview,
        write_preview_page,
    )

    look = Look(size=size + size % 2, framing=framing, view=view, avatar=avatar)
    read = []
    for path, name in zip(motions, distinct_names(motions), strict=True):
        motion = read_previewed(path, name, speech=speech, frame_rate=fps, joint_map=joint_map)
        read.append(motion)
        for note in motion.notes:
            click.echo(f"note: {note}")
        for kind in kinds:
            if kind != PAGE:
                click.echo(" and ".join(map(str, write_preview(motion, kind, out, look))))
    if PAGE in kinds:
        click.echo(_with_size(write_preview_page(read, out, look)))


def _with_size(page: Path) -> str:
    """Return a page's path and how large it is."""
    return f"{page}, {page.stat().st_size / 1e6:.1f} MB; open it in a browser"
