"""`motionjury serve`."""

from __future__ import annotations

import click

from studyapp.command.arguments import study_folder
from studyapp.definition.folder import StudyFolder
from studyapp.serving import run_server


@click.command("serve")
@study_folder
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on.")
@click.option("--port", default=8000, show_default=True, type=click.IntRange(1, 65535))
@click.option("--workers", default=2, show_default=True, type=click.IntRange(1, 64))
@click.option(
    "--new-version",
    is_flag=True,
    help="Go on with a changed design; earlier answers are kept apart.",
)
def command(folder: StudyFolder, host: str, port: int, workers: int, new_version: bool) -> None:
    """Serve the study FOLDER to participants.

    Answers go to responses.db in the folder, or to the database that DATABASE_URL names.
    """
    run_server(
        folder.root,
        host,
        port,
        workers,
        new_version=new_version,
        on_ready=lambda: click.echo(
            f"Take part at http://{host}:{port}/ (Ctrl-C stops the server)."
        ),
    )
