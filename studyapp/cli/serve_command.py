"""`motionjury serve`, and `motionjury deploy` for a server."""

from __future__ import annotations

import os
import sys
from contextlib import closing
from pathlib import Path, PurePosixPath
from typing import cast
from urllib.parse import urlsplit

import click

from motion.errors import InputError
from studyapp.cli.arguments import public_address, study_folder
from studyapp.clock import Clock
from studyapp.custody.deployment import (
    DATABASES,
    PORT,
    PROXIES,
    DatabaseKind,
    Proxy,
    planned_deployment,
)
from studyapp.custody.server_files import write_deployment
from studyapp.database.engine import Database, database_url_of
from studyapp.recruitment.invitations import make_test_participation
from studyapp.researchers.audit import COMMAND_LINE
from studyapp.researchers.links import first_owner_link
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder
from studyapp.web.mounting import checked_prefix, path_to_try
from studyapp.web.server import THREADS, WORKERS, run_server


@click.command("serve")
@study_folder
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on.")
@click.option("--port", default=8000, show_default=True, type=click.IntRange(1, 65535))
@click.option("--workers", default=WORKERS, show_default=True, type=click.IntRange(1, 64))
@click.option(
    "--threads",
    default=THREADS,
    show_default=True,
    type=click.IntRange(1, 512),
    help="Requests that each worker handles at once; slow connections do not count.",
)
@click.option(
    "--accel-redirect",
    metavar="PREFIX",
    envvar="MOTIONJURY_ACCEL_REDIRECT",
    help="Leave the videos to nginx, which has the study folder under this internal location.",
)
@click.option(
    "--media-store",
    is_flag=True,
    envvar="MOTIONJURY_MEDIA_STORE",
    help="Let participants load the videos from the store that 'publish-media' has filled.",
)
@click.option(
    "--prefix",
    default="",
    metavar="PATH",
    envvar="MOTIONJURY_PREFIX",
    help="Serve below this path of the host, such as /studies/one; a proxy passes it on whole.",
)
@public_address(default=None, help="Where a proxy serves the study; the links printed begin so.")
@click.option(
    "--try",
    "is_tried",
    is_flag=True,
    help="Print, and open, a link to take part as a test, which takes no place and never counts.",
)
@click.option(
    "--new-version",
    is_flag=True,
    help="Go on with a changed design; earlier answers are kept apart.",
)
def command(
    folder: StudyFolder,
    host: str,
    port: int,
    workers: int,
    threads: int,
    accel_redirect: str | None,
    media_store: bool,
    prefix: str,
    address: str,
    is_tried: bool,
    new_version: bool,
) -> None:
    """Serve the study FOLDER to participants.

    Answers go to responses.db in the folder, or to the database that DATABASE_URL names.
    """
    below = checked_prefix(prefix)
    if address and urlsplit(address).path != below:
        raise InputError(
            "the address and the path below which the study is served do not fit together",
            where=f"address {address!r}, prefix {prefix!r}",
            remedy="Let the address end with the prefix",
        )
    where = address or f"http://{host}:{port}{below}"
    run_server(
        folder.root,
        host,
        port,
        workers,
        threads=threads,
        accel_prefix=accel_redirect,
        prefix=prefix,
        new_version=new_version,
        from_store=media_store,
        origin=address.removesuffix(below),
        on_ready=lambda: _say_where(folder, where, is_tried=is_tried),
    )


def _say_where(folder: StudyFolder, address: str, *, is_tried: bool) -> None:
    """Say where to take part and where to watch; until the study has an owner, how to be it."""
    click.echo(f"Take part at {address}/ (Ctrl-C stops the server).")
    if is_tried:
        served = ServedStudy.read(folder.root)
        own = make_test_participation(folder.root, served, Clock(), by=COMMAND_LINE)
        link = address + path_to_try(own)
        click.echo(f"Take part as a test at {link} (for one test; it never counts).")
        if os.environ.get("DISPLAY") or sys.platform == "darwin":
            click.launch(link)
    with closing(Database.open(database_url_of(folder.root))) as database:
        token = first_owner_link(database, Clock())
    if token is None:
        click.echo(f"Watch how it goes at {address}/research/.")
    else:
        click.echo(
            f"Become the study's owner at {address}/research/join/{token} (once, within a day)."
        )


@click.command("deploy")
@study_folder
@click.option("--host", required=True, help="Name of the server, such as study.example.org.")
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    required=True,
    help="A new folder for the files.",
)
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
def deploy_command(
    folder: StudyFolder,
    host: str,
    out: Path,
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
    for file in write_deployment(deployment, out):
        goes = f"{file.place} (mode {file.mode:03o})" if file.place else "stays where it is"
        click.echo(f"{out / file.name}: {goes}")
    click.echo(f"On the server, as root: sh {out / 'install'}. docs/deploy.md says what else.")
