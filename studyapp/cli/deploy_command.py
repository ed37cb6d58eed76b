"""`motionjury deploy`."""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from typing import cast

import click

from studyapp.cli.arguments import study_folder
from studyapp.custody.deployment import (
    DATABASES,
    PORT,
    PROXIES,
    DatabaseKind,
    Proxy,
    planned_deployment,
)
from studyapp.custody.server_files import NAMES, deployed_file, write_deployment
from studyapp.study.folder import StudyFolder


@click.command("deploy")
@study_folder
@click.option("--host", required=True, help="Name of the server, such as study.example.org.")
@click.option("--print", "name", type=click.Choice(NAMES), help="Print this one file.")
@click.option("--all", "everything", is_flag=True, help="Write all files into the folder --out.")
@click.option("--out", type=click.Path(path_type=Path), help="A new folder for the files of --all.")
@click.option(
    "--proxy",
    type=click.Choice(PROXIES),
    default=PROXIES[0],
    show_default=True,
    help="Who speaks HTTPS. Caddy needs less doing; nginx sends the videos itself.",
)
@click.option(
    "--database",
    type=click.Choice(DATABASES),
    default=DATABASES[0],
    show_default=True,
    help="Where answers go.",
)
@click.option(
    "--prefix",
    default="",
    metavar="PATH",
    help="Serve below this path of the host, such as /studies/one.",
)
@click.option("--contact", default="", help="Mail address for the issuer of certificates.")
@click.option(
    "--port",
    type=click.IntRange(1024, 65535),
    default=PORT,
    show_default=True,
    help="Where the study's server listens, for the proxy alone; another one for each study.",
)
@click.option(
    "--folder-there",
    metavar="PATH",
    help="Where the study folder lies on the server, if this is not the server.",
)
def command(
    folder: StudyFolder,
    host: str,
    name: str | None,
    everything: bool,
    out: Path | None,
    proxy: str,
    database: str,
    prefix: str,
    contact: str,
    port: int,
    folder_there: str | None,
) -> None:
    """Write the files with which a server serves the study FOLDER to the world.

    docs/deploy.md says step by step what to do with them.
    """
    deployment = planned_deployment(
        title=folder.study().title,
        folder=PurePosixPath(folder_there) if folder_there else folder.root.resolve(),
        host=host,
        prefix=prefix,
        proxy=cast(Proxy, proxy),
        database=cast(DatabaseKind, database),
        contact=contact,
        port=port,
    )
    if name is not None and not everything and out is None:
        click.echo(deployed_file(deployment, name).text, nl=False)
        return
    if name is not None or not everything or out is None:
        raise click.UsageError("Give either --print NAME, or --all with --out FOLDER.")
    for file in write_deployment(deployment, out):
        goes = f"{file.place} (mode {file.mode:03o})" if file.place else "stays where it is"
        click.echo(f"{out / file.name}: {goes}")
    click.echo(f"On the server, as root: sh {out / 'install'}. docs/deploy.md says what else.")
