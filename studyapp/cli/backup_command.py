"""`motionjury backup` and `motionjury restore`."""

from pathlib import Path

import click

from motion.errors import counted
from studyapp.cli.arguments import EXISTING_FILE, FOLDER, StudyCommand, study_folder
from studyapp.cli.output import progress
from studyapp.clock import Clock
from studyapp.custody.backup import back_up
from studyapp.custody.manifest import Manifest
from studyapp.custody.restoration import restore
from studyapp.study.folder import StudyFolder, format_size


@click.command("backup", cls=StudyCommand)
@study_folder
@click.argument("out", type=click.Path(path_type=Path))
@click.option("--with-media", is_flag=True, help="Include speech, motion, networks and videos.")
@click.option(
    "--keep",
    type=click.IntRange(1),
    help="If OUT is a folder: keep only this many of the study's backups, the newest ones.",
)
def command(folder: StudyFolder, out: Path, with_media: bool, keep: int | None) -> None:
    """Back up the study FOLDER into OUT, a .zip file; the study may be running.

    A backup holds the answers (SQLite, or the database of DATABASE_URL), the study file, the
    pseudonym key and everything else that cannot be recreated; see 'motionjury restore'. If OUT is
    a folder, each backup gets its own name there. Nothing is ever overwritten.
    """
    with progress("Backing up", "file") as on_file:
        backup = back_up(folder, out, Clock(), media=with_media, keep=keep, on_file=on_file)
    click.echo(f"Backed up {_contents(backup.manifest)}, from {backup.database}")
    click.echo(
        f"Wrote {backup.path} ({format_size(backup.path.stat().st_size)}). Keep it as safe as the "
        "answers: it identifies people."
    )
    if not with_media:
        click.echo("It holds no speech, motion and videos; --with-media includes them.")
    for path in backup.removed:
        click.echo(f"Removed the older {path}")


def _contents(manifest: Manifest) -> str:
    return (
        f"{counted(manifest.participants, 'participant')} with {manifest.answers} answers, as of "
        f"{manifest.made_at:%Y-%m-%d %H:%M:%S} UTC"
    )


@click.command("restore")
@click.argument("archive", type=EXISTING_FILE)
@click.argument("folder", type=FOLDER)
def restore_command(archive: Path, folder: Path) -> None:
    """Restore the study in the backup ARCHIVE to the new or empty FOLDER.

    The whole backup is checked first. Answers go to responses.db in FOLDER, or to the database of
    DATABASE_URL, which must be empty; every backup fits both. 'motionjury serve' then continues the
    study.
    """
    with progress("Restoring", "file") as on_file:
        manifest, database = restore(archive, StudyFolder(folder), Clock(), on_file=on_file)
    click.echo(f"Restored {_contents(manifest)}, to {folder} and {database}")
    click.echo("'motionjury check' names speech and videos that the backup did not hold.")
    click.echo(
        f"Participants who were erased or withdrew after {manifest.made_at:%Y-%m-%d %H:%M:%S} UTC "
        "are back with all their data. Erase them again with 'motionjury forget'."
    )
