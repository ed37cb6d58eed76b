"""`motionjury preview`."""

from __future__ import annotations

from pathlib import Path

import click

from motion.formats.joint_maps import JointMap
from renderer.avatars import AVATARS, FIRST
from renderer.look import FRAMINGS, Look
from studyapp.cli.arguments import joints_option

_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@click.command("preview")
@click.argument("motions", nargs=-1, required=True, type=_FILE, metavar="FILE...")
@click.option("--speech", type=_FILE, help="What is heard.")
@click.option("--fps", type=click.FloatRange(0, 1000, min_open=True), help="True frame rate.")
@joints_option
@click.option("--avatar", type=click.Choice(list(AVATARS)), default=FIRST, show_default=True)
@click.option(
    "--framing", type=click.Choice(list(FRAMINGS)), default="full_body", show_default=True
)
@click.option("--size", type=click.IntRange(64, 2160), default=720, show_default=True)
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("preview"),
    show_default=True,
    help="The folder to write into.",
)
def command(
    motions: tuple[Path, ...],
    speech: Path | None,
    fps: float | None,
    joint_map: JointMap | None,
    avatar: str,
    framing: str,
    size: int,
    out: Path,
) -> None:
    """Show each motion FILE as a video and as a sheet of its frames; no study is needed."""
    # Imported here: drawing takes a second to load, and a wrong option should be told at once.
    from studyapp.stimuli.motion_preview import write_preview

    look = Look(size=size + size % 2, framing=framing, avatar=avatar)
    for motion in motions:
        made = write_preview(motion, out, look, speech=speech, frame_rate=fps, joint_map=joint_map)
        for note in made.notes:
            click.echo(f"note: {note}")
        click.echo(f"{made.video} and {made.sheet}")
