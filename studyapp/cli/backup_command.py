"""`motionjury backup` and `motionjury restore`."""

from __future__ import annotations

from pathlib import Path

import click

from motion.errors import InputError, listed
from studyapp.cli.arguments import optional_study_folder
from studyapp.cli.output import progress
from studyapp.clock import Clock
from studyapp.custody.backup import Backup, back_up, check_archive
from studyapp.custody.manifest import Manifest, media_amiss
from studyapp.custody.restoration import Restored, restore
from studyapp.stimuli.disk_space import as_text
from studyapp.study.folder import StudyFolder


@click.command("backup")
@optional_study_folder
@click.argument("out", required=False, type=click.Path(path_type=Path))
@click.option("--with-media", is_flag=True, help="Include speech, motion, networks and videos.")
@click.option(
    "--keep",
    type=click.IntRange(1),
    help="If OUT is a folder: keep so many of this study's backups there, the newest ones.",
)
@click.option(
    "--check",
    "checked",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="Check this backup instead of making one; with FOLDER, also whether the media that it "
    "does not hold are there.",
)
def command(
    folder: StudyFolder | None,
    out: Path | None,
    with_media: bool,
    keep: int | None,
    checked: Path | None,
) -> None:
    """Back up the study FOLDER into OUT, a .tar or .tar.gz, while it may be served.

    It holds the answers (SQLite, or the database that DATABASE_URL names), the study file, the key
    of the pseudonyms and everything else that cannot be made again; see 'motionjury restore'. If
    OUT is a folder, each backup gets a name of its own there. Nothing is ever overwritten.
    """
    if checked is not None:
        if out is not None or with_media or keep is not None:
            raise InputError(
                "--check makes no backup",
                remedy="Leave out OUT, --with-media and --keep, or --check",
            )
        _check(checked, folder)
        return
    if folder is None or out is None:
        raise click.UsageError("Say which study to back up, and where: FOLDER OUT.")
    with progress("Backing up", "file") as on_file:
        made = back_up(folder, out, Clock(), media=with_media, keep=keep, on_file=on_file)
    _say_made(made)


def _say_made(made: Backup) -> None:
    click.echo(f"Backed up {contents(made.manifest)}, from {made.database}")
    click.echo(
        f"Wrote {made.path} ({as_text(made.path.stat().st_size)}). Keep it as safe as the answers: "
        "it leads to people."
    )
    if made.manifest.media:
        click.echo(
            f"{len(made.manifest.media)} media files are not in it (--with-media); it knows their "
            "SHA-256."
        )
    for path in made.removed:
        click.echo(f"Removed the older {path}")


def _check(archive: Path, folder: StudyFolder | None) -> None:
    with progress("Checking", "file") as on_file:
        manifest = check_archive(archive, on_file)
    click.echo(f"{archive} is whole: {contents(manifest)}.")
    if folder is None or not manifest.media:
        return
    missing, other = media_amiss(folder.root, manifest.media)
    if missing or other:
        raise InputError(
            f"of {len(manifest.media)} media files that are not in the backup, {len(missing)} are "
            f"missing and {len(other)} are other ones, {(missing + other)[0]} among them",
            where=folder.root,
            remedy="Bring them there, or back up again, with --with-media",
        )
    click.echo(f"The {len(manifest.media)} media files that it does not hold are in {folder.root}.")


def contents(manifest: Manifest) -> str:
    """Return what is in a backup, in words."""
    people = "participant" if manifest.participants == 1 else "participants"
    return (
        f"{manifest.participants} {people} with {manifest.answers} answers, as of "
        f"{manifest.made_at:%Y-%m-%d %H:%M:%S} UTC"
    )


_SHOWN = 3
"""As many files are named."""


@click.command("restore")
@click.argument("archive", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False))
def restore_command(archive: Path, folder: Path) -> None:
    """Bring the study in the backup ARCHIVE back into the new or empty FOLDER.

    The whole backup is checked first. Answers go to responses.db in FOLDER, or to the database that
    DATABASE_URL names, which must be empty: a backup of either kind fits both. 'motionjury serve'
    then goes on where the study was.
    """
    with progress("Restoring", "file") as on_file:
        done = restore(archive, StudyFolder(folder), Clock(), on_file=on_file)
    click.echo(f"Restored {contents(done.manifest)}, to {folder} and {done.database}")
    _say_media(done, folder)
    click.echo(
        f"Whoever was forgotten after {done.manifest.made_at:%Y-%m-%d %H:%M:%S} UTC, or withdrew "
        "then, is back with all that was stored. Erase them again with 'motionjury forget'."
    )


def _say_media(done: Restored, folder: Path) -> None:
    for paths, are in ((done.missing, "are missing"), (done.other, "are not as they were")):
        if paths:
            some = listed([*paths[:_SHOWN], *(["others"] if len(paths) > _SHOWN else [])])
            click.echo(f"{len(paths)} media files {are} in {folder}: {some}. Bring them there.")
