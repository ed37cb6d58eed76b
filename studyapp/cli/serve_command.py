"""`motionjury serve`, `motionjury desk`, and `motionjury deploy` for a server."""

import os
from contextlib import closing
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import urlsplit

import click

from motion.errors import InputError
from studyapp.cli.arguments import (
    FOLDER,
    public_address,
    refuse_options,
    study_folder,
    together,
)
from studyapp.clock import Clock
from studyapp.custody.deployment import (
    DATABASES,
    PORT,
    PROXIES,
    Deployment,
    write_deployment,
)
from studyapp.database.engine import (
    Database,
    database_url_of,
    record_database,
    refuse_second_database,
)
from studyapp.desk.server import open_desk, run_desk
from studyapp.recruitment.invitations import make_test_participation
from studyapp.researchers.audit import COMMAND_LINE
from studyapp.researchers.links import first_owner_link, offer_new_password
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder
from studyapp.web.mounting import checked_prefix, path_to_try
from studyapp.web.server import WORKERS, run_server

_server_options = together(
    click.option(
        "--host",
        default="127.0.0.1",
        # URLs need brackets around IPv6 addresses.
        callback=lambda _c, _o, host: f"[{host.strip('[]')}]" if ":" in host else host,
        help="Address to listen on.",
    ),
    click.option("--port", default=8000, type=click.IntRange(1, 65535)),
    click.option("--workers", default=WORKERS, type=click.IntRange(1, 64)),
    public_address(
        help="The public address, behind a proxy, which must not strip its path; printed links "
        "start with it."
    ),
)
"""The options of a server that is started here."""


@click.command("serve")
@study_folder
@_server_options
@click.option(
    "--accel-redirect",
    "accel_prefix",
    metavar="PREFIX",
    envvar="MOTIONJURY_ACCEL_REDIRECT",
    help="Let nginx send the videos; it maps this internal location to the study folder.",
)
@click.option(
    "--media-store",
    "from_store",
    is_flag=True,
    envvar="MOTIONJURY_MEDIA_STORE",
    help="Let participants load the videos from the store that 'publish-media' filled.",
)
@click.option(
    "--try",
    "as_test",
    is_flag=True,
    help="Print a link for a test run, which takes no place and is never analysed.",
)
@click.option(
    "--new-version",
    is_flag=True,
    help="Continue with a changed design; earlier answers are kept separate.",
)
def command(
    folder: StudyFolder,
    address: str,
    accel_prefix: str | None,
    as_test: bool,
    **server: Any,
) -> None:
    """Serve the study FOLDER to participants.

    Answers are stored in responses.db in the folder, or in the database of DATABASE_URL.
    """
    path = checked_prefix(urlsplit(address).path)
    is_elsewhere = bool(os.environ.get("DATABASE_URL"))
    if not is_elsewhere:
        refuse_second_database(folder)
    url = address or f"http://{server['host']}:{server['port']}"

    def announce() -> None:
        if is_elsewhere:
            record_database(folder, database_url_of(folder.root))
        _print_links(folder, url, as_test=as_test)

    run_server(
        folder.root,
        accel_prefix=accel_prefix,
        prefix=path,
        origin=address.removesuffix(path),
        on_ready=announce,
        **server,
    )


def _print_links(folder: StudyFolder, url: str, *, as_test: bool) -> None:
    """Print the links of participants and researchers, or of the first owner."""
    click.echo(f"Take part at {url}/ (Ctrl-C stops the server).")
    if as_test:
        served = ServedStudy.read(folder.root)
        participation = make_test_participation(folder.root, served, Clock(), by=COMMAND_LINE)
        link = url + path_to_try(participation)
        click.echo(f"Take part as a test at {link} (once; it is never analysed).")
    database = Database.open(database_url_of(folder.root))
    if not _print_owners_link(database, url, "the study's"):
        click.echo(f"Watch the study at {url}/research/.")


@click.command("desk")
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False, exists=True))
@_server_options
@click.option(
    "--reset",
    metavar="NAME",
    help="Serve nothing; print a link that lets the researcher NAME choose a new password.",
)
def desk_command(folder: Path, address: str, reset: str | None, **server: Any) -> None:
    """Serve all studies in FOLDER, each a sub-folder, behind one login.

    Researchers create, watch and change studies in the browser; participants find each study under
    the name of its folder. The desk's accounts are in desk.db in FOLDER.
    """
    url = address or f"http://{server['host']}:{server['port']}"
    if "/" in url.partition("://")[2]:
        raise InputError(
            "a desk needs a host of its own",
            where=f"address {address!r}",
            remedy="Give an address without a path, such as https://studies.example.org",
        )
    if reset is not None:
        with closing(open_desk(folder).database) as database:
            token = offer_new_password(database, Clock(), name=reset, by="")
        click.echo(f"{url}/research/join/{token} (once, within a day).")
        return
    run_desk(folder, origin=address, on_ready=lambda: _print_desk_links(folder, url), **server)


def _print_desk_links(folder: Path, url: str) -> None:
    click.echo(f"The desk is at {url}/research/ (Ctrl-C stops the server).")
    _print_owners_link(open_desk(folder).database, url, "the desk's")


def _print_owners_link(database: Database, url: str, whose: str) -> bool:
    """Print the link of the first owner; return False if there is an owner."""
    with closing(database):
        token = first_owner_link(database, Clock())
    if token is not None:
        click.echo(f"Become {whose} owner at {url}/research/join/{token} (once, within a day).")
    return token is not None


@click.command("deploy")
@click.argument(
    "folder", default=".", type=click.Path(path_type=Path, file_okay=False, exists=True)
)
@click.option("--host", required=True, help="The server's name, such as study.example.org.")
@click.option("--out", type=FOLDER, required=True, help="A new folder for the files.")
@click.option(
    "--proxy",
    type=click.Choice(PROXIES),
    default=PROXIES[0],
    help="What serves HTTPS. Caddy needs less setup; nginx sends the videos itself.",
)
@click.option(
    "--database",
    type=click.Choice(DATABASES),
    default=DATABASES[0],
    help="Where answers are stored.",
)
@click.option(
    "--prefix",
    default="",
    show_default=False,
    metavar="PATH",
    help="Serve under this path of the host, such as /studies/one.",
)
@click.option(
    "--contact",
    default="",
    show_default=False,
    help="E-mail address for the certificate authority.",
)
@click.option(
    "--port",
    type=click.IntRange(1024, 65535),
    default=PORT,
    help="Where the server listens for the proxy; choose another one for each study.",
)
@click.option(
    "--folder-there",
    metavar="PATH",
    help="The folder's path on the server, if this machine is not the server.",
)
def deploy_command(
    folder: Path, out: Path, prefix: str, database: str, folder_there: str | None, **options: Any
) -> None:
    """Write the files that a public server needs to serve FOLDER, a study or a desk.

    A folder without study.toml is a desk: a folder of studies, as of 'motionjury desk'.
    docs/deploy.md explains step by step what to do with them.
    """
    place = PurePosixPath(folder_there or folder.resolve())
    study = StudyFolder(folder)
    if study.definition.exists():
        kind, title = "study", study.study().title
    else:
        kind, title = "desk", place.name
        # A desk has a host of its own, and keeps answers in the studies' own folders.
        refused = {"--prefix": bool(prefix), "--database": database != DATABASES[0]}
        refuse_options([name for name, is_refused in refused.items() if is_refused], "a desk")
    deployment = Deployment(
        kind=kind, title=title, folder=place, prefix=prefix, database=database, **options
    )
    for file in write_deployment(deployment, out):
        target = f"{file.place} (mode {file.mode:03o})" if file.place else "stays in this folder"
        click.echo(f"{out / file.name}: {target}")
    click.echo(
        f"On the {kind}'s server, as root: sh {out / 'install'}. See docs/deploy.md for the rest."
    )
