"""`motionjury render`, `motionjury preview` and `motionjury publish-media`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import click

from motion.errors import InputError, counted
from renderer.look import AVATARS, FIRST_AVATAR, FRAMINGS, VIEWS, Look
from studyapp.cli.arguments import (
    EXISTING_FILE,
    FOLDER,
    StudyCommand,
    file_rate_option,
    joints_option,
    processes_option,
    public_address,
    study_folder,
)
from studyapp.cli.output import echo_note, progress, sign_of_life
from studyapp.study.folder import StudyFolder

if TYPE_CHECKING:
    from studyapp.web.media_store import Place


@click.command("render")
@study_folder
@processes_option
@click.option(
    "--cluster",
    metavar="ADDRESS",
    help="Render on the Dask cluster whose scheduler is at ADDRESS, such as tcp://node1:8786. "
    "Its workers need the same version, and the study under the same path.",
)
@click.option("--sheet", is_flag=True, help="Also write a contact sheet of every clip.")
def command(
    folder: StudyFolder,
    processes: int,
    cluster: str | None,
    sheet: bool,
) -> None:
    """Render the clips and side-by-side pairs of the study FOLDER.

    Finished videos are kept: run the command again to continue an interrupted run.
    """
    # Imported here: drawing takes a second to load, which --help should not wait for.
    from studyapp.stimuli.rendering import render

    with progress("render", "frame") as show:
        count = render(folder, processes=processes, cluster=cluster, on_progress=show)
    for note in count.notes:
        click.secho(f"warning: {note}", fg="yellow", err=True)
    for failure in count.failures:
        click.echo(f"failed: {failure}", err=True)
    if count.left_out:
        click.echo(f"skipped {counted(count.left_out, 'video')} made from these clips", err=True)
    click.echo(f"Rendered {counted(count.made, 'video')}, kept {count.kept} up-to-date ones.")
    if sheet:
        # Imported here: it needs matplotlib, which rendering alone does not.
        from studyapp.stimuli.figures.contact_sheet import write_contact_sheet

        with progress("sheet", "clip") as show:
            page = write_contact_sheet(folder, threads=processes, on_done=show)
        click.echo(f"The contact sheet is {page}")
    if count.failures:
        raise InputError(
            f"{counted(len(count.failures) + count.left_out, 'video')} could not be made",
            where=folder.videos,
            remedy="Fix what is named above and run the command again",
        )


@click.command("preview")
@click.argument("motions", nargs=-1, required=True, type=EXISTING_FILE, metavar="FILE...")
@click.option("--speech", type=EXISTING_FILE, help="The speech.")
@file_rate_option
@joints_option
@click.option("--avatar", type=click.Choice(list(AVATARS)), default=FIRST_AVATAR)
@click.option("--framing", type=click.Choice(list(FRAMINGS)), default="full_body")
@click.option("--view", type=click.Choice(list(VIEWS)), default="front")
@click.option(
    "--size", type=click.IntRange(64, 2160), default=720, help="Pixels along each side of a video."
)
@click.option(
    "--as",
    "kinds",
    type=click.Choice(["page", "video", "glb", "bvh"]),
    multiple=True,
    default=["page"],
    help="What to write; can be repeated: a page on which all motions play side by side and can "
    "be turned around, a video of each, or files for other programs.",
)
@click.option("--out", type=FOLDER, default=Path("preview"), help="The output folder.")
def preview_command(
    motions: tuple[Path, ...],
    avatar: str,
    framing: str,
    view: str,
    size: int,
    kinds: tuple[str, ...],
    out: Path,
    **reading: Any,
) -> None:
    """Show each motion FILE in three dimensions, as a video, GLB or BVH; no study is needed."""
    # Imported here: drawing takes a second to load, which --help should not wait for.
    from studyapp.stimuli.figures.motion_preview import (
        PAGE,
        distinct_names,
        read_previewed,
        write_preview,
        write_preview_page,
    )

    look = Look(size=size + size % 2, framing=framing, view=view, avatar=avatar)
    previewed = []
    for path, name in zip(motions, distinct_names(motions), strict=True):
        with sign_of_life("preview") as show:
            show(f"reading {path.name}")
            motion = read_previewed(path, name, **reading)
            for note in motion.notes:
                echo_note(note)
            files = [write_preview(motion, kind, out, look, show) for kind in kinds if kind != PAGE]
        previewed.append(motion)
        for written in files:
            click.echo(" and ".join(map(str, written)))
    if PAGE in kinds:
        with sign_of_life("preview") as show:
            show("packing motion")
            page = write_preview_page(previewed, out, look)
        click.echo(f"{page}, {page.stat().st_size / 1e6:.1f} MB; open it in a browser")


@click.command("publish-media", cls=StudyCommand)
@study_folder
@click.argument("bucket", required=False, metavar="[s3://BUCKET/FOLDER]")
@click.option(
    "--endpoint",
    default="",
    show_default=False,
    metavar="URL",
    help="The store's address, such as https://s3.example.org, unless it is Amazon's.",
)
@click.option(
    "--region",
    default="",
    show_default=False,
    help="The store's region, unless the environment names it.",
)
@public_address(
    help="The study's public address; tests that its pages can load from the bucket.",
)
def publish_media_command(
    folder: StudyFolder,
    bucket: str | None,
    endpoint: str,
    region: str,
    address: str,
) -> None:
    """Upload the videos of the study FOLDER to an S3-compatible store.

    With 'motionjury serve --media-store', participants load them from there by signed addresses
    that expire. The bucket must not be public. Run the command again after an interruption or a
    rendering; without a bucket, it uploads to the previous one. boto3 finds the keys, for example
    in AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY.
    """
    # Imported here: it loads the database, which rendering does not need.
    from studyapp.stimuli.publishing import publish, require_loading

    if bucket is None and (endpoint or region):
        raise click.UsageError("Give --endpoint and --region together with s3://BUCKET/FOLDER.")
    place = None if bucket is None else _parse_place(bucket, endpoint, region)
    with progress("Publishing", "file") as on_file:
        publication = publish(folder, place, on_file)
    click.echo(f"Uploaded {publication.stored} copies; {publication.kept} were already there.")
    if address:
        parts = urlsplit(address)
        origin = f"{parts.scheme}://{parts.netloc}"
        require_loading(folder, origin)
        click.echo(f"Pages of {origin} can load them; without a signed address, nobody can.")


def _parse_place(bucket: str, endpoint: str, region: str) -> Place:
    from studyapp.web.media_store import Place

    parts, store = urlsplit(bucket), urlsplit(endpoint)
    path = parts.path.strip("/")
    if endpoint and store.scheme != "https" and store.hostname not in ("127.0.0.1", "localhost"):
        raise InputError(
            "browsers only load videos over https",
            where=f"--endpoint {endpoint}",
            remedy="Give an address that begins with https://",
        )
    try:
        if parts.scheme != "s3" or parts.query or parts.fragment:
            raise ValueError
        return Place(
            bucket=parts.netloc,
            folder=f"{path}/" if path else "",
            endpoint=endpoint.rstrip("/"),
            region=region,
        )
    except ValueError:
        raise InputError(
            "this is not the name of a bucket",
            where=bucket,
            remedy="Write s3://my-bucket/my-study, in lower-case letters, digits, dots and hyphens",
        ) from None
