"""`motionjury publish-media`."""

from __future__ import annotations

from urllib.parse import urlsplit

import click

from motion.errors import InputError
from studyapp.cli.arguments import named_study_folder, public_address
from studyapp.cli.output import progress
from studyapp.stimuli.publishing import let_in, publish, remove
from studyapp.study.folder import StudyFolder
from studyapp.web.media_store import Place

_SCHEME = "s3"


@click.command("publish-media")
@named_study_folder
@click.argument("bucket", required=False, metavar="[s3://BUCKET/FOLDER]")
@click.option(
    "--endpoint",
    default="",
    metavar="URL",
    help="The store's address, if it is not Amazon's: https://s3.example.org",
)
@click.option("--region", default="", help="The store's region; else that of the environment.")
@public_address(
    default=None,
    help="Where the study is served: lets its pages load from the bucket, and tries that.",
)
@click.option(
    "--remove-unused",
    is_flag=True,
    help="Remove what is in the bucket's FOLDER but is no video of the study any more. A server "
    "that was started before may still need it.",
)
def command(
    folder: StudyFolder,
    bucket: str | None,
    endpoint: str,
    region: str,
    address: str,
    remove_unused: bool,
) -> None:
    """Bring the videos of the study FOLDER into an S3-compatible store.

    Participants then load them there, by addresses that expire: 'motionjury serve --media-store'.
    The bucket must not be public. Run it again after an interruption or a rendering; without a
    bucket, to where it was published before. Keys are taken from AWS_ACCESS_KEY_ID and
    AWS_SECRET_ACCESS_KEY, or wherever boto3 finds them.
    """
    if bucket is None and (endpoint or region):
        raise click.UsageError("--endpoint and --region belong to a bucket: s3://BUCKET/FOLDER.")
    place = None if bucket is None else _place(bucket, endpoint, region)
    with progress("Publishing", "copy") as on_file:
        done = publish(folder, place, on_file)
    click.echo(f"Stored {done.stored} copies; {done.kept} were there.")
    if address:
        parts = urlsplit(address)
        origin = f"{parts.scheme}://{parts.netloc}"
        let_in(folder, origin)
        click.echo(f"Pages of {origin} can load them, and nobody can without a signed address.")
    if done.unused and remove_unused:
        remove(folder, done.unused)
        click.echo(f"Removed {len(done.unused)} objects that were no video of now.")
    elif done.unused:
        click.echo(
            f"{len(done.unused)} objects there are no video of now; --remove-unused removes them."
        )


def _place(bucket: str, endpoint: str, region: str) -> Place:
    """Return the place that is named on the command line."""
    parts = urlsplit(bucket)
    inside = parts.path.strip("/")
    secure = urlsplit(endpoint).scheme == "https" or urlsplit(endpoint).hostname in (
        "127.0.0.1",
        "localhost",
    )
    if endpoint and not secure:
        raise InputError(
            "browsers load videos by https alone",
            where=f"--endpoint {endpoint}",
            remedy="Give an address that begins with https://",
        )
    try:
        if parts.scheme != _SCHEME or parts.query or parts.fragment:
            raise ValueError
        return Place(
            bucket=parts.netloc,
            folder=f"{inside}/" if inside else "",
            endpoint=endpoint.rstrip("/"),
            region=region,
        )
    except ValueError:
        raise InputError(
            "this names no bucket",
            where=bucket,
            remedy="Write s3://my-bucket/my-study, in small letters, digits, dots and hyphens",
        ) from None
