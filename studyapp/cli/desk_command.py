"""`motionjury desk`."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import click

from motion.errors import InputError
from studyapp.cli.arguments import public_address
from studyapp.clock import Clock
from studyapp.desk.app import open_desk
from studyapp.desk.server import run_desk
from studyapp.researchers.links import first_owner_link, offer_new_password
from studyapp.web.server import THREADS, WORKERS


@click.command("desk")
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False, exists=True))
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
@public_address(default=None, help="Where a proxy serves the desk; the links shown begin so.")
@click.option(
    "--reset",
    metavar="NAME",
    help="Serve nothing; print a link with which the researcher NAME chooses a new password.",
)
def command(
    folder: Path,
    host: str,
    port: int,
    workers: int,
    threads: int,
    address: str,
    reset: str | None,
) -> None:
    """Serve all studies in FOLDER, each a sub-folder, behind one login.

    Researchers make, watch and change studies in the browser; participants find each study below
    the name of its folder. Accounts of the desk are in desk.db in FOLDER.
    """
    where = address or f"http://{host}:{port}"
    if "/" in where.partition("://")[2]:
        raise InputError(
            "a desk has a host to itself",
            where=f"address {address!r}",
            remedy="Give an address without a path, such as https://studies.example.org",
        )
    if reset is not None:
        with closing(open_desk(folder).database) as database:
            token = offer_new_password(database, Clock(), name=reset, by="")
        click.echo(f"{where}/research/join/{token} (once, within a day).")
        return
    run_desk(
        folder,
        host,
        port,
        workers,
        threads=threads,
        origin=address,
        on_ready=lambda: _say_where(folder, where),
    )


def _say_where(folder: Path, address: str) -> None:
    """Say where the desk is; until it has an owner, how to be it."""
    click.echo(f"The desk is at {address}/research/ (Ctrl-C stops the server).")
    with closing(open_desk(folder).database) as database:
        token = first_owner_link(database, Clock())
    if token is not None:
        click.echo(
            f"Become the desk's owner at {address}/research/join/{token} (once, within a day)."
        )
