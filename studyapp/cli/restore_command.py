"""`motionjury restore`."""

from __future__ import annotations

from pathlib import Path

import click

from motion.listing import listed
from studyapp.cli.backup_command import contents
from studyapp.cli.progress import progress
from studyapp.clock import Clock
from studyapp.custody.restoration import Restored, restore
from studyapp.study.folder import StudyFolder

_SHOWN = 3
"""As many files are named."""


@click.command("restore")
@click.argument("archive", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False))
@click.option(
    "--forgotten-in",
    metavar="BACKUP",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="A later backup of the same study: whom it has forgotten, and what it deleted of who "
    "withdrew, is erased here as well.",
)
def command(archive: Path, folder: Path, forgotten_in: Path | None) -> None:
    """Bring the study in the backup ARCHIVE back into the new or empty FOLDER.

    All of it is checked first. Answers go to responses.db in FOLDER, or to the database that
    DATABASE_URL names, which must be empty: a backup of either kind fits both. 'motionjury serve'
    then goes on where the study was.
    """
    with progress("Restoring", "file") as on_file:
        done = restore(
            archive, StudyFolder(folder), Clock(), forgotten_in=forgotten_in, on_file=on_file
        )
    click.echo(f"Restored {contents(done.manifest)}, to {folder} and {done.database}")
    _say_media(done, folder)
    _say_who_is_back(done)


def _say_media(done: Restored, folder: Path) -> None:
    for paths, are in ((done.missing, "are missing"), (done.other, "are not as they were")):
        if paths:
            some = listed([*paths[:_SHOWN], *(["others"] if len(paths) > _SHOWN else [])])
            click.echo(f"{len(paths)} media files {are} in {folder}: {some}. Bring them there.")


def _say_who_is_back(done: Restored) -> None:
    moment = f"{done.manifest.made_at:%Y-%m-%d %H:%M:%S} UTC"
    if done.erased is None:
        click.echo(
            f"Whoever was forgotten after {moment}, or withdrew then, is back with all that was "
            "stored. Erase them again: with 'motionjury forget', or by restoring once more with "
            "--forgotten-in and a later backup."
        )
        return
    again = done.erased
    click.echo(
        f"Erased again: {again.forgotten} forgotten, {again.withdrawn} who withdrew, "
        f"{again.screened_out} who were screened out. Who was forgotten or withdrew after that "
        "later backup is still to be erased by hand."
    )
